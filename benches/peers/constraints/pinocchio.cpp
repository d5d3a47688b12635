// Pinocchio's constrained dynamics with the interface of src/peers/library.rs.
#include "../model.hpp"
#include <fstream>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <sstream>
#include <vector>

namespace {
using Eigen::Vector3d;
using Eigen::VectorXd;
using namespace pinocchio;

struct State {
    VectorXd q, v;
};

struct Spring {
    JointIndex joint;
    Vector3d ground, at;
    double stiffness, free_length;
};

// Planar loops have a redundant row, for which the proximal method needs a small compliance. With independent rows it
// needs none.
const ProximalSettings SETTINGS[] = {ProximalSettings(1e-12, 0., 1), ProximalSettings(1e-12, 1e-10, 10),
                                     ProximalSettings(1e-12, 1e-7, 10)};
constexpr size_t VARIANTS = sizeof SETTINGS / sizeof *SETTINGS;

struct Robot {
    Model model;
    Data data;
    std::vector<JointIndex> order;
    std::vector<RigidConstraintModel> constraints;
    std::vector<RigidConstraintData> work;
    std::vector<Spring> springs;
    VectorXd torques, tau, a;
    double step = 0;
    std::vector<State> states;

    Robot(const std::string &folder, const double *numbers, size_t length, size_t count)
        : model(load(folder)), data(model), torques(VectorXd::Zero(model.nv)), tau(torques), a(torques) {
        std::ifstream(folder + "/step") >> step;
        std::ifstream names(folder + "/order"), loops(folder + "/loops"), known(folder + "/torques");
        for (std::string name; names >> name;) order.push_back(model.getJointId(name));
        for (std::string name; known >> name;) known >> torques[model.joints[model.getJointId(name)].idx_v()];
        for (std::string word; loops >> word;) read(word, loops);
        for (const auto &constraint : constraints) work.emplace_back(constraint);
        initConstraintDynamics(model, data, constraints, work);
        for (size_t k = 0; k < count; ++k, numbers += length) {
            State s{VectorXd(model.nq), VectorXd(model.nv)};
            const double *q = numbers, *v = numbers + model.nq;
            for (JointIndex j : order) {
                const auto &joint = model.joints[j];
                for (int i = 0; i < joint.nq(); ++i) s.q[joint.idx_q() + i] = *q++;
                for (int i = 0; i < joint.nv(); ++i) s.v[joint.idx_v() + i] = *v++;
            }
            states.push_back(s);
        }
    }

    void read(const std::string &word, std::istream &in) {
        const auto vector = [&] {
            Vector3d v;
            in >> v[0] >> v[1] >> v[2];
            return v;
        };
        JointIndex joint, other;
        in >> joint;
        if (word == "spring") {
            Spring s{joint, vector(), vector(), 0, 0};
            in >> s.stiffness >> s.free_length;
            springs.push_back(s);
        } else {
            const SE3 first(Eigen::Matrix3d::Identity(), vector());
            in >> other;
            const SE3 second(Eigen::Matrix3d::Identity(), vector());
            constraints.emplace_back(CONTACT_3D, model, joint, first, other, second, LOCAL);
        }
    }

    const VectorXd &accelerations(const VectorXd &q, const VectorXd &v, ProximalSettings &settings) {
        tau = torques;
        for (const Spring &s : springs) {
            // The body rotates about z at a point of the ground.
            const auto &joint = model.joints[s.joint];
            const double angle = q[joint.idx_q()], c = std::cos(angle), n = std::sin(angle);
            const Vector3d arm(c * s.at[0] - n * s.at[1], n * s.at[0] + c * s.at[1], 0);
            const Vector3d stretch = model.jointPlacements[s.joint].translation() + arm - s.ground;
            const double length = stretch.norm();
            const Vector3d force = stretch * (-s.stiffness * (length - s.free_length) / length);
            tau[joint.idx_v()] += arm[0] * force[1] - arm[1] * force[0];
        }
        return constraintDynamics(model, data, q, v, tau, constraints, work, settings);
    }
};

template <int VARIANT>
void evaluate(Robot *r, size_t k) {
    ProximalSettings settings = SETTINGS[VARIANT];
    r->a = r->accelerations(r->states[k].q, r->states[k].v, settings);
}

// Simulates a hundred steps of the classical Runge-Kutta method, without projections.
template <int VARIANT>
void motion(Robot *r, size_t k) {
    ProximalSettings settings = SETTINGS[VARIANT];
    const double h = r->step, part[] = {0, h / 2, h / 2, h}, weight[] = {h / 6, h / 3, h / 3, h / 6};
    VectorXd q = r->states[k].q, v = r->states[k].v, a = v, rate = v, at = q, moved = v, faster = v;
    for (int step = 0; step < 100; ++step) {
        moved.setZero();
        faster.setZero();
        for (int s = 0; s < 4; ++s) {
            if (s) integrate(r->model, q, rate * part[s], at);
            else at = q;
            rate = s ? VectorXd(v + part[s] * a) : v;
            a = r->accelerations(at, rate, settings);
            moved += weight[s] * rate;
            faster += weight[s] * a;
        }
        integrate(r->model, q, moved, at);
        q = at;
        v += faster;
    }
    r->a = v;
}

using Step = void (*)(Robot *, size_t);
const Step ACCELERATIONS[] = {evaluate<0>, evaluate<1>, evaluate<2>}, MOTIONS[] = {motion<0>, motion<1>, motion<2>};
} // namespace

extern "C" Robot *peer_open(const char *folder, const double *states, size_t length, size_t count) {
    if (!std::ifstream(std::string(folder) + "/model.txt")) return nullptr;
    return new Robot(folder, states, length / count, count);
}

extern "C" Step peer_step_fn(Robot *, size_t function, size_t variant) {
    if (variant >= VARIANTS) return nullptr;
    return function == 5 ? ACCELERATIONS[variant] : function == 6 ? MOTIONS[variant] : nullptr;
}

extern "C" void peer_result(Robot *r, size_t, size_t, double *out) {
    for (JointIndex j : r->order) {
        const auto &joint = r->model.joints[j];
        for (int i = 0; i < joint.nv(); ++i) *out++ = r->a[joint.idx_v() + i];
    }
}
