// Shared by the C++ programs: Pinocchio's model of a robot, and coordinates in Linkwork's order.
#pragma once
#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>
#include <string>

// Loads the model that `models.py` has saved. (It is an archive, because the parser of URDF files is in a compiled library,
// whose matrices are aligned for another processor.)
inline pinocchio::Model load(const std::string &folder) {
    pinocchio::Model model;
    model.loadFromText(folder + "/model.txt");
    return model;
}

// Whether the joint is continuous: Pinocchio stores its angle as a cosine and a sine.
template <class Joint>
bool endless(const Joint &joint) {
    return joint.nq() == 2 && joint.nv() == 1;
}

// Returns the number of coordinates if each such angle is one number.
inline int coordinates(const pinocchio::Model &model) {
    int count = 0;
    for (const auto &joint : model.joints) count += joint.idx_q() < 0 ? 0 : endless(joint) ? 1 : joint.nq();
    return count;
}

// Returns Pinocchio's configuration for the coordinates `from`.
template <class Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, 1> configuration(const pinocchio::Model &model, const Scalar *from) {
    using std::cos;
    using std::sin;
    Eigen::Matrix<Scalar, Eigen::Dynamic, 1> q(model.nq);
    for (const auto &joint : model.joints) {
        if (joint.idx_q() < 0) continue; // the universe
        if (endless(joint)) {
            q[joint.idx_q()] = cos(*from);
            q[joint.idx_q() + 1] = sin(*from);
            ++from;
        } else {
            for (int k = 0; k < joint.nq(); ++k) q[joint.idx_q() + k] = *from++;
        }
    }
    return q;
}
