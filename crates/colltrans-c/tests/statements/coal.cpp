// Five tasks with Coal 3.0. count.py counts their statements. Coal has no continuous collision of two bodies, so
// `advance` searches for the contact.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <coal/BVH/BVH_model.h>
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include "inputs.hpp"

// task: cast
// Conservative advancement: each step is the distance over the speed along its normal.
double advance(const coal::CollisionGeometry &moving, const coal::Transform3s &start, const coal::CollisionGeometry &fixed,
               const coal::Vec3s &direction) {
    const coal::DistanceRequest request;
    double travel = 0;
    for (int step = 0; step < 1000; ++step) {
        const coal::Transform3s at(start.getRotation(), start.getTranslation() + travel * direction);
        coal::DistanceResult result;
        const double gap = coal::distance(&moving, at, &fixed, coal::Transform3s(), request, result);
        if (gap < 1e-6) return travel;
        const double speed = (result.nearest_points[1] - result.nearest_points[0]).dot(direction) / gap;
        if (speed <= 0) return INFINITY;
        travel += gap / speed;
    }
    return travel;
}
double cast() {
    const coal::Box parcel(1, 1, 1);
    const coal::Box floor(100, 100, 2);
    const coal::Transform3s start(coal::Quatf(0.8, 0.6, 0, 0), coal::Vec3s(0, 0, 10));
    return advance(parcel, start, floor, coal::Vec3s(0, 0, -1));
}

// task: distance
// The faces of the hull are input.
double distance() {
    auto vertices = std::make_shared<std::vector<coal::Vec3s>>();
    for (const point &of : corners) vertices->emplace_back(of[0], of[1], of[2]);
    auto faces = std::make_shared<std::vector<coal::Triangle>>();
    *faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const coal::Convex<coal::Triangle> tetrahedron(vertices, 4, faces, 4);
    const coal::Sphere ball(0.5);
    const coal::Transform3s there(coal::Vec3s(3, 4, 0));
    const coal::DistanceRequest request;
    coal::DistanceResult result;
    return coal::distance(&ball, coal::Transform3s(), &tetrahedron, there, request, result);
}

// task: many poses
// `advance` of the first task is counted there.
std::vector<double> many_poses() {
    const coal::Box part(1, 1, 1);
    const coal::Box table(10, 10, 2);
    std::vector<double> distances;
    for (const point &at : places) {
        const coal::Transform3s start(coal::Vec3s(at[0], at[1], at[2]));
        distances.push_back(advance(part, start, table, coal::Vec3s(0, 0, -1)));
    }
    return distances;
}

// task: mesh against mesh
coal::BVHModel<coal::OBBRSS> mesh(const std::vector<point> &vertices, const std::vector<std::uint32_t> &triangles) {
    std::vector<coal::Vec3s> positions;
    for (const point &of : vertices) positions.emplace_back(of[0], of[1], of[2]);
    std::vector<coal::Triangle> facets;
    for (std::size_t k = 0; k < triangles.size(); k += 3) facets.emplace_back(triangles[k], triangles[k + 1], triangles[k + 2]);
    coal::BVHModel<coal::OBBRSS> made;
    made.beginModel();
    made.addSubModel(positions, facets);
    made.endModel();
    return made;
}
double mesh_against_mesh() {
    const auto wedge = mesh(wedge_vertices, wedge_triangles);
    const auto bracket = mesh(bracket_vertices, bracket_triangles);
    return advance(wedge, coal::Transform3s(), bracket, coal::Vec3s(0, 0, -1));
}

// task: tracked loop
double tracked_loop() {
    auto vertices = std::make_shared<std::vector<coal::Vec3s>>();
    for (const point &of : corners) vertices->emplace_back(of[0], of[1], of[2]);
    auto faces = std::make_shared<std::vector<coal::Triangle>>();
    *faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const coal::Convex<coal::Triangle> tetrahedron(vertices, 4, faces, 4);
    const coal::Box floor(18, 18, 1);
    const coal::Transform3s below(coal::Vec3s(0, 0, -0.5));
    const coal::ComputeDistance compute(&tetrahedron, &floor);
    coal::DistanceRequest request;
    request.gjk_initial_guess = coal::GJKInitialGuess::CachedGuess;
    double least = 1e9;
    for (int step = 0; step <= 100; ++step) {
        const double half = 0.005 * step;
        const coal::Transform3s pose(coal::Quatf(std::cos(half), std::sin(half), 0, 0), coal::Vec3s(0.02 * step, 0, 3));
        coal::DistanceResult result;
        least = std::fmin(least, compute(pose, below, request, result));
        request.updateGuess(result);
    }
    return least;
}

// end
int main() {
    const auto falls = many_poses();
    std::printf("%.6f %.6f %.6f %.6f %.6f %.6f\n", cast(), distance(), falls[0], falls[2], mesh_against_mesh(),
                tracked_loop());
}
