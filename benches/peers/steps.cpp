// Generates a step of the classical Runge-Kutta method with its Jacobians as C by CasADi from Pinocchio's algorithms on symbols: steps FOLDER
//
// Writes to the folder `step_plain.c` and `step_shared.c` (common subexpressions eliminated), each from the formulation that takes the
// fewest instructions: the Jacobians by algorithmic differentiation of the step, or through its stages from Pinocchio's analytic
// derivatives of forward dynamics. All joints of the arm have one coordinate.
#include <pinocchio/autodiff/casadi.hpp>
#include "model.hpp"
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <functional>
#include <iostream>
#include <unistd.h>
#include <vector>

using casadi::Slice;
using casadi::SX;
using Model = pinocchio::ModelTpl<SX>;
using Data = pinocchio::DataTpl<SX>;
using Vector = Eigen::Matrix<SX, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<SX, Eigen::Dynamic, Eigen::Dynamic>;

const double PERIOD = 0.01;

static Vector numbers(const SX &symbols) {
    Vector v(symbols.size1());
    for (int k = 0; k < v.size(); ++k) v[k] = symbols(k);
    return v;
}

static SX sparse(const Matrix &m) {
    SX result(m.rows(), m.cols());
    for (int j = 0; j < m.cols(); ++j)
        for (int i = 0; i < m.rows(); ++i)
            if (!m(i, j).is_zero()) result(i, j) = m(i, j);
    return result;
}

// Returns the state after a step, from the acceleration as a function of the state.
static SX step(const SX &q, const SX &v, const std::function<SX(const SX &, const SX &)> &acceleration) {
    const double h = PERIOD;
    const SX a1 = acceleration(q, v);
    const SX v2 = v + h / 2 * a1, a2 = acceleration(q + h / 2 * v, v2);
    const SX v3 = v + h / 2 * a2, a3 = acceleration(q + h / 2 * v2, v3);
    const SX v4 = v + h * a3, a4 = acceleration(q + h * v3, v4);
    return SX::vertcat({q + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)});
}

int main(int count, char **arguments) {
    // CasADi writes only to the working directory.
    if (count != 2 || chdir(arguments[1])) return 2;
    const Model model = load(".").cast<SX>();
    const int n = model.nv;
    const SX q = SX::sym("q", n), v = SX::sym("v", n), u = SX::sym("u", n);

    const SX end = step(q, v, [&](const SX &q, const SX &v) {
        Data data(model);
        return sparse(pinocchio::aba(model, data, numbers(q), numbers(v), numbers(u), pinocchio::Convention::LOCAL));
    });
    const SX differentiated = SX::horzcat({SX::jacobian(end, q), SX::jacobian(end, v), SX::jacobian(end, u)});

    // States, followed by their derivatives with respect to the start.
    const SX one = SX::eye(n), none(n, n);
    const SX whole = step(SX::horzcat({q, one, none, none}), SX::horzcat({v, none, one, none}), [&](const SX &q, const SX &v) {
        Data data(model);
        pinocchio::computeABADerivatives(model, data, numbers(q(Slice(), 0)), numbers(v(Slice(), 0)), numbers(u));
        Matrix inverse = data.Minv;
        for (int j = 0; j < n; ++j)
            for (int i = j + 1; i < n; ++i) inverse(i, j) = inverse(j, i);
        const Slice all(1, 3 * n + 1);
        const SX along = mtimes(sparse(data.ddq_dq), q(Slice(), all)) + mtimes(sparse(data.ddq_dv), v(Slice(), all));
        return SX::horzcat({sparse(data.ddq), along + SX::horzcat({SX(n, 2 * n), sparse(inverse)})});
    });
    const SX carried = whole(Slice(), Slice(1, 3 * n + 1));

    casadi::Function plain, shared;
    for (const SX &e : {SX::densify(differentiated), SX::densify(carried)}) {
        const casadi::Function p("f", {q, v, u}, {e}), s("f", {q, v, u}, {cse(e)});
        std::cout << "  " << p.n_instructions() << ", " << s.n_instructions() << std::endl;
        if (plain.is_null() || p.n_instructions() < plain.n_instructions()) plain = p;
        if (shared.is_null() || s.n_instructions() < shared.n_instructions()) shared = s;
    }
    plain.generate("step_plain.c");
    shared.generate("step_shared.c");
}
