// Computes distances of two bodies, and the depth of an overlap.
#include <array>
#include <cstdio>
#include <vector>

#include <colltrans.hpp>

namespace ct = colltrans;

int main() {
    const std::vector<std::array<double, 3>> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const ct::body tetrahedron = *ct::body::convex(corners);
    const ct::body center = *ct::body::convex(std::vector<double>{0, 0, 0});
    const ct::body ball = *center.rounded(0.5);
    const ct::pose there = ct::pose::from_translation({3, 4, 0});

    const ct::distance_answer apart = *ct::distance(ball, {}, tetrahedron, there);
    std::printf("distance %.9g, nearest point of the ball (%.9g, %.9g, %.9g)\n", apart.upper,
                apart.point_on_moving[0], apart.point_on_moving[1], apart.point_on_moving[2]);
    const bool is_closer = ct::within(ball, {}, tetrahedron, there, 4.4)->outcome == COLLTRANS_CLOSER;
    std::printf("closer than 4.4: %s\n", is_closer ? "yes" : "no");
    const ct::depth_answer overlap = *ct::depth(ball, {}, tetrahedron, {});
    std::printf("at the origin they overlap by %.9g\n", overlap.upper);
}
