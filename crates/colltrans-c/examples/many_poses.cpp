// Lowers a part from many poses at once: tables in, columns out, on all processors.
#include <cstdio>
#include <vector>

#include <colltrans.hpp>

namespace ct = colltrans;

int main() {
    const ct::body part = *ct::body::cuboid({0, 0, 0}, {1, 1, 1});
    const ct::body table = *ct::body::cuboid({-5, -5, -1}, {5, 5, 0});
    std::vector<ct::pose> poses;
    for (int k = 0; k < 1000; ++k) poses.push_back(ct::pose::from_translation({0.01 * k - 6, 0, 2 + 0.001 * k}));

    ct::rows rows;
    rows.moving_poses = poses;
    const std::vector<double> down = {0, 0, -1};
    rows.directions = down;

    std::vector<ct::outcome> outcomes(poses.size());
    std::vector<double> distances(poses.size());
    ct::cast_columns columns{};
    columns.outcome = outcomes.data();
    columns.distance = distances.data();
    *ct::clearance_many(part, table, rows, columns);

    std::size_t blocked = 0;
    for (const ct::outcome outcome : outcomes) blocked += outcome == COLLTRANS_BLOCKED;
    std::printf("%zu of %zu are above the table; the last one falls %.9g\n", blocked, poses.size(), distances.back());
}
