// A pendulum in C++: energies of a motion are constant.
#include "linkwork.h"
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

struct Robot {
    std::unique_ptr<lw_robot, void (*)(lw_robot *)> handle{nullptr, lw_free};

    explicit Robot(const char *text) {
        lw_robot *robot = nullptr;
        check(lw_declare(text, nullptr, &robot));
        handle.reset(robot);
    }

    static void check(int code) {
        if (code != LW_OK) {
            throw std::runtime_error(lw_message());
        }
    }

    std::vector<double> call(const char *name, std::vector<const double *> arguments) const {
        std::size_t f = 0;
        check(lw_index(handle.get(), LW_FUNCTIONS, name, &f));
        std::vector<double> results(lw_length(handle.get(), f));
        check(lw_call(handle.get(), f, arguments.data(), results.data()));
        return results;
    }
};

int main() {
    const Robot robot(
        "#[mechanism(gravity = -9.81 * y)] struct Pendulum {"
        "#[body(mass = 2, com = -0.5 * y, inertia = rod(2, 1, y))] rod: Body,"
        "#[joint(ground -> rod, about = z)] hinge: Pin }");
    double q = 0.5, v = 0.0;
    const double tau = 0.0, h = 1e-3;
    const auto energy = [&] {
        return robot.call("kinetic_energy", {&q, &v})[0] + robot.call("potential_energy", {&q})[0];
    };
    const double before = energy();
    for (int step = 0; step < 1000; ++step) {
        // Velocity Verlet.
        v += 0.5 * h * robot.call("forward_dynamics", {&q, &v, &tau})[0];
        q += h * v;
        v += 0.5 * h * robot.call("forward_dynamics", {&q, &v, &tau})[0];
    }
    try {
        robot.call("missing", {});
        return 2;
    } catch (const std::runtime_error &) {
    }
    return std::abs(energy() - before) < 1e-5 ? 0 : 1;
}
