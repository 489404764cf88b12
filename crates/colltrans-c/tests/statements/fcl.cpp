// Five tasks with FCL 0.7. count.py counts their statements.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <fcl/fcl.h>

#include "inputs.hpp"

// task: cast
// The path has an end, so its length is a guess.
double cast() {
    const fcl::Boxd parcel(1, 1, 1);
    const fcl::Boxd floor(100, 100, 2);
    fcl::Transform3d start = fcl::Transform3d::Identity();
    start.translate(fcl::Vector3d(0, 0, 10));
    start.rotate(fcl::Quaterniond(0.8, 0.6, 0, 0));
    const double length = 20;
    fcl::Transform3d end = start;
    end.pretranslate(fcl::Vector3d(0, 0, -length));
    const fcl::ContinuousCollisionRequestd request(1000, 1e-6, fcl::CCDM_TRANS, fcl::GST_INDEP,
                                                   fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
    fcl::ContinuousCollisionResultd result;
    const fcl::Transform3d rest = fcl::Transform3d::Identity();
    fcl::continuousCollide(&parcel, start, end, &floor, rest, rest, request, result);
    return length * result.time_of_contact;
}

// task: distance
// The faces of the hull are input.
double distance() {
    auto vertices = std::make_shared<std::vector<fcl::Vector3d>>();
    for (const point &of : corners) vertices->emplace_back(of[0], of[1], of[2]);
    const auto faces = std::make_shared<std::vector<int>>(std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3});
    const fcl::Convexd tetrahedron(vertices, 4, faces);
    const fcl::Sphered ball(0.5);
    fcl::Transform3d there = fcl::Transform3d::Identity();
    there.translate(fcl::Vector3d(3, 4, 0));
    const fcl::DistanceRequestd request(true);
    fcl::DistanceResultd result;
    const fcl::Transform3d rest = fcl::Transform3d::Identity();
    return fcl::distance(&ball, rest, &tetrahedron, there, request, result);
}

// task: many poses
std::vector<double> many_poses() {
    const fcl::Boxd part(1, 1, 1);
    const fcl::Boxd table(10, 10, 2);
    const fcl::Transform3d rest = fcl::Transform3d::Identity();
    const double length = 20;
    const fcl::ContinuousCollisionRequestd request(1000, 1e-6, fcl::CCDM_TRANS, fcl::GST_INDEP,
                                                   fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
    std::vector<double> distances;
    for (const point &at : places) {
        fcl::Transform3d start = fcl::Transform3d::Identity();
        start.translate(fcl::Vector3d(at[0], at[1], at[2]));
        fcl::Transform3d end = start;
        end.pretranslate(fcl::Vector3d(0, 0, -length));
        fcl::ContinuousCollisionResultd result;
        fcl::continuousCollide(&part, start, end, &table, rest, rest, request, result);
        distances.push_back(length * result.time_of_contact);
    }
    return distances;
}

// task: mesh against mesh
// Conservative advancement reports no contact of these meshes, so 1000 poses are tested.
fcl::BVHModel<fcl::OBBRSSd> mesh(const std::vector<point> &vertices, const std::vector<std::uint32_t> &triangles) {
    std::vector<fcl::Vector3d> positions;
    for (const point &of : vertices) positions.emplace_back(of[0], of[1], of[2]);
    std::vector<fcl::Triangle> facets;
    for (std::size_t k = 0; k < triangles.size(); k += 3) facets.emplace_back(triangles[k], triangles[k + 1], triangles[k + 2]);
    fcl::BVHModel<fcl::OBBRSSd> made;
    made.beginModel();
    made.addSubModel(positions, facets);
    made.endModel();
    return made;
}
double mesh_against_mesh() {
    const auto wedge = mesh(wedge_vertices, wedge_triangles);
    const auto bracket = mesh(bracket_vertices, bracket_triangles);
    const fcl::Transform3d rest = fcl::Transform3d::Identity();
    const double length = 20;
    fcl::Transform3d end = rest;
    end.translate(fcl::Vector3d(0, 0, -length));
    const fcl::ContinuousCollisionRequestd request(1000, 1e-6, fcl::CCDM_TRANS, fcl::GST_INDEP,
                                                   fcl::CCDC_NAIVE);
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&wedge, rest, end, &bracket, rest, rest, request, result);
    return length * result.time_of_contact;
}

// task: tracked loop
// Distances start from scratch.
double tracked_loop() {
    auto vertices = std::make_shared<std::vector<fcl::Vector3d>>();
    for (const point &of : corners) vertices->emplace_back(of[0], of[1], of[2]);
    const auto faces = std::make_shared<std::vector<int>>(std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3});
    const fcl::Convexd tetrahedron(vertices, 4, faces);
    const fcl::Boxd floor(18, 18, 1);
    fcl::Transform3d below = fcl::Transform3d::Identity();
    below.translate(fcl::Vector3d(0, 0, -0.5));
    const fcl::DistanceRequestd request;
    double least = 1e9;
    for (int step = 0; step <= 100; ++step) {
        const double half = 0.005 * step;
        fcl::Transform3d pose = fcl::Transform3d::Identity();
        pose.translate(fcl::Vector3d(0.02 * step, 0, 3));
        pose.rotate(fcl::Quaterniond(std::cos(half), std::sin(half), 0, 0));
        fcl::DistanceResultd result;
        least = std::fmin(least, fcl::distance(&tetrahedron, pose, &floor, below, request, result));
    }
    return least;
}

// end
int main() {
    const auto falls = many_poses();
    std::printf("%.6f %.6f %.6f %.6f %.6f %.6f\n", cast(), distance(), falls[0], falls[2], mesh_against_mesh(),
                tracked_loop());
}
