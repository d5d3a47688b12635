// Generates C by CasADi from Pinocchio's algorithms on symbols: generate LIMIT FOLDER
//
// Writes to every folder `FUNCTION_plain.c` and `FUNCTION_shared.c` (common subexpressions eliminated), each from the
// formulation that takes the fewest instructions. Derivatives of robots with more than LIMIT velocities are omitted.
#include <pinocchio/autodiff/casadi.hpp>
#include "model.hpp"
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <cstdlib>
#include <iostream>
#include <unistd.h>
#include <vector>

using casadi::SX;
using pinocchio::Convention;
using Model = pinocchio::ModelTpl<SX>;
using Data = pinocchio::DataTpl<SX>;
using Vector = Eigen::Matrix<SX, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<SX, Eigen::Dynamic, Eigen::Dynamic>;

// Maximum number of velocities for which algorithmic differentiation is tried in addition to the analytic recursions.
const int DIFFERENTIATE = 12;

static Vector numbers(const SX &symbols) {
    Vector v(symbols.size1());
    for (int k = 0; k < v.size(); ++k) v[k] = symbols(k);
    return v;
}

static SX dense(const Matrix &m) {
    SX result(casadi::Sparsity::dense(m.rows(), m.cols()));
    for (int j = 0; j < m.cols(); ++j)
        for (int i = 0; i < m.rows(); ++i) result(i, j) = m(i, j);
    return result;
}

static SX symmetric(const Matrix &upper) {
    Matrix m = upper;
    for (int j = 0; j < m.cols(); ++j)
        for (int i = j + 1; i < m.rows(); ++i) m(i, j) = m(j, i);
    return dense(m);
}

static void write(const std::string &name, const casadi::SXVector &inputs, const std::vector<SX> &formulations) {
    casadi::Function plain, shared;
    for (const SX &e : formulations) {
        const casadi::Function p("f", inputs, {e}), s("f", inputs, {cse(e)});
        if (plain.is_null() || p.n_instructions() < plain.n_instructions()) plain = p;
        if (shared.is_null() || s.n_instructions() < shared.n_instructions()) shared = s;
    }
    plain.generate(name + "_plain.c");
    shared.generate(name + "_shared.c");
    std::cout << "  " << name << ": " << plain.n_instructions() << ", " << shared.n_instructions() << std::endl;
}

struct Robot {
    pinocchio::Model numeric;
    Model model;
    SX q, v, x;
    Vector configuration_, velocity, third;

    explicit Robot(const char *folder)
        : numeric(load(folder)), model(numeric.cast<SX>()), q(SX::sym("q", coordinates(numeric))),
          v(SX::sym("v", numeric.nv)), x(SX::sym("x", numeric.nv)),
          configuration_(configuration(numeric, numbers(q).data())), velocity(numbers(v)), third(numbers(x)) {}

    SX inverse() const {
        Data data(model);
        return dense(pinocchio::rnea(model, data, configuration_, velocity, third));
    }
    SX mass(Convention convention) const {
        Data data(model);
        pinocchio::crba(model, data, configuration_, convention);
        return symmetric(data.M);
    }
    SX forward(Convention convention) const {
        Data data(model);
        return dense(pinocchio::aba(model, data, configuration_, velocity, third, convention));
    }
    SX inverse_derivatives() const {
        Data data(model);
        pinocchio::computeRNEADerivatives(model, data, configuration_, velocity, third);
        return SX::horzcat({dense(data.dtau_dq), dense(data.dtau_dv)});
    }
    SX forward_derivatives() const {
        Data data(model);
        pinocchio::computeABADerivatives(model, data, configuration_, velocity, third);
        return SX::horzcat({dense(data.ddq_dq), dense(data.ddq_dv), symmetric(data.Minv)});
    }
    SX derivatives(const SX &of, const std::vector<SX> &by) const {
        std::vector<SX> parts;
        for (const SX &s : by) parts.push_back(SX::densify(SX::jacobian(of, s)));
        return SX::horzcat(parts);
    }
};

static void generate(const char *folder, int limit) {
    const Robot r(folder);
    const SX inverse = r.inverse(), forward = r.forward(Convention::LOCAL);
    const casadi::SXVector inputs{r.q, r.v, r.x};
    write("inverse", inputs, {inverse});
    write("mass", inputs, {r.mass(Convention::LOCAL), r.mass(Convention::WORLD)});
    write("forward", inputs, {forward, r.forward(Convention::WORLD)});
    if (r.numeric.nv > limit) return;
    std::vector<SX> by_inverse{r.inverse_derivatives()}, by_forward{r.forward_derivatives()};
    if (r.q.size1() == r.numeric.nv && r.numeric.nv <= DIFFERENTIATE) {
        by_inverse.push_back(r.derivatives(inverse, {r.q, r.v}));
        by_forward.push_back(r.derivatives(forward, {r.q, r.v, r.x}));
    }
    write("inverse_derivatives", inputs, by_inverse);
    write("forward_derivatives", inputs, by_forward);
}

int main(int count, char **arguments) {
    // CasADi writes only to the working directory.
    if (count != 3 || chdir(arguments[2])) return 2;
    generate(".", std::atoi(arguments[1]));
}
