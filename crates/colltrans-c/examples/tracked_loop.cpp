// Follows a body in small steps: each query starts from the last answer.
#include <cmath>
#include <cstdio>
#include <vector>

#include <colltrans.hpp>

namespace ct = colltrans;

int main() {
    std::vector<double> circle;
    for (int k = 0; k < 200; ++k) {
        const double angle = 0.0314159265 * k;
        for (const double z : {0.0, 0.5}) circle.insert(circle.end(), {std::cos(angle), std::sin(angle), z});
    }
    const ct::body disc = *ct::body::convex(circle);
    const ct::body floor = *ct::body::cuboid({-9, -9, -1}, {9, 9, 0});

    ct::tracker tracker = *ct::tracker::make();
    double least = 1e9;
    for (int step = 0; step <= 100; ++step) {
        const double half = 0.005 * step;
        const auto pose = ct::pose::from_quaternion({std::sin(half), 0, 0, std::cos(half)}, {0.02 * step, 0, 3});
        const ct::distance_answer found = *tracker.distance(disc, *pose, floor, {});
        if (found.upper < least) least = found.upper;
    }
    std::printf("the least distance is %.6f\n", least);
}
