// Views of Eigen's matrices, blocks, maps and transforms.
#include <colltrans.hpp>

#include <Eigen/Geometry>

namespace ct = colltrans;

static void check(int line, bool holds) {
    if (!holds) {
        std::fprintf(stderr, "line %d: does not hold: %s\n", line, colltrans_error_message());
        std::exit(1);
    }
}
#define CHECK(...) check(__LINE__, (__VA_ARGS__))

static bool is_view_of(const ct::points &of, const Eigen::Matrix3Xd &expected) {
    if (of.size() != static_cast<std::size_t>(expected.cols())) return false;
    for (std::size_t k = 0; k < 3 * of.size(); ++k) {
        if (of.data()[k] != expected.data()[k]) return false;
    }
    return true;
}

static bool is_view_of(const ct::vector &of, const Eigen::Vector3d &expected) {
    return of.data()[0] == expected[0] && of.data()[1] == expected[1] && of.data()[2] == expected[2];
}

static ct::points by_reference(const Eigen::Ref<const Eigen::Matrix3Xd, 0, Eigen::OuterStride<>> &of) { return of; }

static void tables() {
    for (const int count : {1, 2, 3, 4}) {
        Eigen::Matrix4Xd homogeneous(4, count);
        for (int k = 0; k < 4 * count; ++k) homogeneous.data()[k] = k + 1;
        const Eigen::Matrix3Xd points = homogeneous.topRows<3>();
        const Eigen::MatrixX3d in_rows = points.transpose();
        const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> in_stored_rows = in_rows;
        CHECK(is_view_of(points, points) && ct::points(points).data() == points.data());
        CHECK(is_view_of(homogeneous.topRows<3>(), points) && is_view_of(by_reference(homogeneous.topRows<3>()), points));
        CHECK(is_view_of(in_rows, points));
        CHECK(is_view_of(in_stored_rows, points) && ct::points(in_stored_rows).data() == in_stored_rows.data());
        const Eigen::MatrixXd any = points;
        CHECK(is_view_of(any, points));
        for (int k = 0; k < count; ++k) {
            CHECK(is_view_of(ct::vector(points.col(k)), points.col(k)));
            CHECK(is_view_of(ct::vector(in_rows.row(k)), points.col(k)));
            CHECK(is_view_of(ct::vector(in_stored_rows.row(k)), points.col(k)));
        }
        std::vector<Eigen::Vector3d> list;
        for (int k = 0; k < count; ++k) list.push_back(points.col(k));
        CHECK(is_view_of(list, points));
    }
}

static void poses() {
    Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
    turned.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    turned.translation() << 5, 6, 7;
    const Eigen::Affine3d affine(turned.matrix());
    const Eigen::AffineCompact3d compact(affine);
    const Eigen::Transform<double, 3, Eigen::Isometry, Eigen::RowMajor> by_rows(turned);
    const Eigen::Matrix4d matrix = turned.matrix();
    const auto is_turned = [](const ct::result<ct::pose> &found) {
        return found && found->rotation[1] == 1 && found->rotation[3] == -1 && found->translation[2] == 7;
    };
    CHECK(is_turned(ct::pose::from_matrix(turned)) && is_turned(ct::pose::from_matrix(affine)));
    CHECK(is_turned(ct::pose::from_matrix(compact)) && is_turned(ct::pose::from_matrix(by_rows)));
    CHECK(is_turned(ct::pose::from_matrix(matrix)) && is_turned(ct::pose::from_matrix(turned.affine())));
    CHECK(ct::pose::from_matrix(Eigen::Isometry3d(Eigen::Isometry3d::Identity())).has_value());
}

int main() {
    tables();
    poses();
}
