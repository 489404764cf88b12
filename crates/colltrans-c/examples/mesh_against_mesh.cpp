// Lowers a wedge of triangles onto a bracket, a union of two boxes, and verifies the proof.
#include <cstdint>
#include <cstdio>
#include <vector>

#include <colltrans.hpp>

namespace ct = colltrans;

int main() {
    // The bracket is not convex.
    const ct::body foot = *ct::body::cuboid({0, 0, 0}, {4, 1, 1}), wall = *ct::body::cuboid({0, 0, 0}, {1, 1, 3});
    const ct::body bracket = *ct::body::pieces({&foot, &wall});

    // Triangles are counter-clockwise as seen from outside.
    const std::vector<double> vertices = {2, 0, 4, 3, 0, 4, 2, 1, 4, 3, 1, 4, 2, 0, 5, 2, 1, 5};
    const std::vector<std::uint32_t> triangles = {0, 2, 1, 1, 2, 3, 0, 1, 4, 2, 5, 3,
                                                  0, 4, 2, 2, 4, 5, 1, 3, 4, 3, 5, 4};
    const auto wedge = ct::body::solid(vertices, triangles);
    if (!wedge) {
        std::fprintf(stderr, "%s\n", wedge.error().message.c_str());
        return 1;
    }

    const ct::cast_answer down = *ct::clearance(*wedge, {}, bracket, {}, {0, 0, -1});
    std::printf("down %.9g to the foot\n", down.distance);
    const ct::cast_answer left = *ct::clearance(*wedge, {}, bracket, {}, {-1, 0, 0});
    std::printf("left: %s\n", left.outcome == COLLTRANS_FREE ? "free" : "blocked");

    const ct::proof proof = *ct::clearance_proof(*wedge, {}, bracket, {}, {0, 0, -1});
    std::printf("proof of %s, %s\n", proof.size() > 1000 ? "some kilobytes" : "some bytes",
                ct::check_proof(proof) ? "verified" : "rejected");
}
