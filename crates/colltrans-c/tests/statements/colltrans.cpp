// Five tasks with colltrans. count.py counts their statements.
#include <cmath>
#include <cstdio>
#include <vector>

#include <colltrans.hpp>

#include "inputs.hpp"

namespace ct = colltrans;

// task: cast
double cast() {
    const ct::body parcel = *ct::body::cuboid({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
    const ct::body floor = *ct::body::cuboid({-50, -50, -1}, {50, 50, 1});
    const ct::pose start = *ct::pose::from_quaternion({0.6, 0, 0, 0.8}, {0, 0, 10});
    return ct::first_contact(parcel, start, floor, {}, {0, 0, -1})->translation;
}

// task: distance
double distance() {
    const ct::body tetrahedron = *ct::body::convex(corners);
    const ct::body ball = *ct::body::convex(std::vector<double>{0, 0, 0})->rounded(0.5);
    const ct::pose there = ct::pose::from_translation({3, 4, 0});
    return ct::distance(ball, {}, tetrahedron, there)->upper;
}

// task: many poses
std::vector<double> many_poses() {
    const ct::body part = *ct::body::cuboid({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
    const ct::body table = *ct::body::cuboid({-5, -5, -1}, {5, 5, 1});
    std::vector<ct::pose> poses;
    for (const auto &at : places) poses.push_back(ct::pose::from_translation(at));
    const std::vector<double> down = {0, 0, -1};
    ct::rows rows;
    rows.moving_poses = poses;
    rows.directions = down;
    std::vector<double> distances(poses.size());
    ct::cast_columns columns{};
    columns.distance = distances.data();
    *ct::clearance_many(part, table, rows, columns);
    return distances;
}

// task: mesh against mesh
double mesh_against_mesh() {
    const ct::body wedge = *ct::body::solid(wedge_vertices, wedge_triangles);
    const ct::body bracket = *ct::body::solid(bracket_vertices, bracket_triangles);
    return ct::clearance(wedge, {}, bracket, {}, {0, 0, -1})->distance;
}

// task: tracked loop
double tracked_loop() {
    const ct::body tetrahedron = *ct::body::convex(corners);
    const ct::body floor = *ct::body::cuboid({-9, -9, -1}, {9, 9, 0});
    ct::tracker tracker = *ct::tracker::make();
    double least = 1e9;
    for (int step = 0; step <= 100; ++step) {
        const double half = 0.005 * step;
        const ct::pose pose = *ct::pose::from_quaternion({std::sin(half), 0, 0, std::cos(half)}, {0.02 * step, 0, 3});
        least = std::fmin(least, tracker.distance(tetrahedron, pose, floor, {})->upper);
    }
    return least;
}

// end
int main() {
    const auto falls = many_poses();
    std::printf("%.6f %.6f %.6f %.6f %.6f %.6f\n", cast(), distance(), falls[0], falls[2], mesh_against_mesh(),
                tracked_loop());
}
