// The input of the tasks: corners of a tetrahedron, places of a box, two meshes.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

using point = std::array<double, 3>;

const std::vector<point> corners = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
const std::vector<point> places = {{{0, 0, 3}}, {{1, 1, 4}}, {{-1, 2, 5}}};

// Vertices of a mesh, and three indices for each triangle, counter-clockwise as seen from outside.
const std::vector<point> wedge_vertices = {{{2, 0, 4}}, {{3, 0, 4}}, {{2, 1, 4}}, {{3, 1, 4}}, {{2, 0, 5}}, {{2, 1, 5}}};
const std::vector<std::uint32_t> wedge_triangles = {0, 2, 1, 1, 2, 3, 0, 1, 4, 2, 5, 3, 0, 4, 2, 2, 4, 5, 1, 3, 4, 3, 5, 4};
// A block of 4 x 1 x 1.
const std::vector<point> bracket_vertices = {{{0, 0, 0}}, {{4, 0, 0}}, {{0, 1, 0}}, {{4, 1, 0}},
                                             {{0, 0, 1}}, {{4, 0, 1}}, {{0, 1, 1}}, {{4, 1, 1}}};
const std::vector<std::uint32_t> bracket_triangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
