// Pinocchio's algorithms with the interface of src/peers/library.rs. They are used header-only, so that they are
// compiled for the host's processor.
#include "model.hpp"
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <vector>

namespace {
using Eigen::MatrixXd;
using Eigen::VectorXd;
using pinocchio::Convention;

struct State {
    VectorXd q, v, a, tau;
};

struct Robot {
    pinocchio::Model model;
    pinocchio::Data data;
    std::vector<State> states;

    Robot(const char *folder, const double *numbers, size_t count) : model(load(folder)), data(model) {
        const int nq = coordinates(model), nv = model.nv;
        for (size_t k = 0; k < count; ++k, numbers += nq + 3 * nv) {
            const auto vector = [&](int i) { return VectorXd(Eigen::Map<const VectorXd>(numbers + nq + i * nv, nv)); };
            states.push_back({configuration(model, numbers), vector(0), vector(1), vector(2)});
        }
    }
};

using Step = void (*)(Robot *, size_t);

void inverse(Robot *r, size_t k) {
    const State &s = r->states[k];
    pinocchio::rnea(r->model, r->data, s.q, s.v, s.a);
}
template <Convention C>
void mass(Robot *r, size_t k) {
    pinocchio::crba(r->model, r->data, r->states[k].q, C);
}
template <Convention C>
void forward(Robot *r, size_t k) {
    const State &s = r->states[k];
    pinocchio::aba(r->model, r->data, s.q, s.v, s.tau, C);
}
void inverse_derivatives(Robot *r, size_t k) {
    const State &s = r->states[k];
    pinocchio::computeRNEADerivatives(r->model, r->data, s.q, s.v, s.a);
}
void forward_derivatives(Robot *r, size_t k) {
    const State &s = r->states[k];
    pinocchio::computeABADerivatives(r->model, r->data, s.q, s.v, s.tau);
}

const std::vector<Step> STEPS[] = {
    {inverse},
    {mass<Convention::LOCAL>, mass<Convention::WORLD>},
    {forward<Convention::LOCAL>, forward<Convention::WORLD>},
    {inverse_derivatives},
    {forward_derivatives},
};

double *put(double *out, const Eigen::Ref<const MatrixXd> &m) {
    Eigen::Map<MatrixXd>(out, m.rows(), m.cols()) = m;
    return out + m.size();
}
MatrixXd symmetric(const Eigen::Ref<const MatrixXd> &m) { return m.selfadjointView<Eigen::Upper>(); }
} // namespace

extern "C" Robot *peer_open(const char *folder, const double *states, size_t, size_t count) {
    return new Robot(folder, states, count);
}

extern "C" Step peer_step_fn(Robot *, size_t function, size_t variant) {
    const auto &steps = STEPS[function];
    return variant < steps.size() ? steps[variant] : nullptr;
}

extern "C" void peer_result(Robot *r, size_t function, size_t, double *out) {
    const pinocchio::Data &d = r->data;
    switch (function) {
    case 0: put(out, d.tau); break;
    case 1: put(out, symmetric(d.M)); break;
    case 2: put(out, d.ddq); break;
    case 3: put(put(out, d.dtau_dq), d.dtau_dv); break;
    default: put(put(put(out, d.ddq_dq), d.ddq_dv), symmetric(d.Minv));
    }
}
