// C++17 wrapper of colltrans.h: owning handles, results, views. Header only, no dependency.
//
// - `body`, `motion`, `scene` and `tracker` own a handle. They can be moved; a copy of a body is made by `clone()`.
//   Const functions may be called by any number of threads.
// - Functions that can fail return `result<T>`: a value or an `error` with a status and a text. `value()` of a failure
//   throws `colltrans::exception` if COLLTRANS_EXCEPTIONS is defined before this file is included, otherwise it prints
//   the text and aborts. Files that pass these types to each other need the same choice, otherwise they do not link.
// - Points, directions and matrices are taken from contiguous containers by `data()` and `size()`, or from matrices by
//   `data()`, `rows()` and `cols()`: std::vector, std::array, Eigen's matrices, maps and blocks. Points that lie one
//   after the other in memory are not copied. Indices are contiguous containers of std::uint32_t.

#ifndef COLLTRANS_HPP
#define COLLTRANS_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "colltrans.h"

#ifdef COLLTRANS_EXCEPTIONS
#include <stdexcept>
#endif

namespace colltrans {
// The names differ for the linker, because the functions do.
#ifdef COLLTRANS_EXCEPTIONS
inline namespace throwing {
#else
inline namespace aborting {
#endif

using status = colltrans_status;
using outcome = colltrans_outcome;
using feature = colltrans_feature;
using body_properties = colltrans_body_properties;
using cast_options = colltrans_cast_options;
using cast_answer = colltrans_cast_answer;
using distance_answer = colltrans_distance_answer;
using depth_answer = colltrans_depth_answer;
using motion_answer = colltrans_motion_answer;
using cast_columns = colltrans_cast_columns;
using distance_columns = colltrans_distance_columns;

/// A failed call.
struct error {
    colltrans::status status = COLLTRANS_INTERNAL_ERROR;
    std::string message;
};

#ifdef COLLTRANS_EXCEPTIONS
/// Thrown by `result::value` of a failure.
class exception : public std::runtime_error {
  public:
    explicit exception(const error &failure)
        : std::runtime_error(failure.message), status_(failure.status) {}
    colltrans::status status() const noexcept { return status_; }

  private:
    colltrans::status status_;
};
#endif

namespace detail {

[[noreturn]] inline void fail(const error &failure) {
#ifdef COLLTRANS_EXCEPTIONS
    throw exception(failure);
#else
    std::fprintf(stderr, "colltrans: %s\n", failure.message.c_str());
    std::abort();
#endif
}

inline error last_error(status code) { return {code, colltrans_error_message()}; }

}  // namespace detail

/// A value, or the error of the call that should have computed it.
template <class T>
class [[nodiscard]] result {
  public:
    result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
    result(colltrans::error failure) : content_(std::in_place_index<1>, std::move(failure)) {}

    bool has_value() const noexcept { return content_.index() == 0; }
    /// Checks whether there is a value. A `result<bool>` lacks this conversion, which would be mistaken for its value.
    template <class U = T, std::enable_if_t<!std::is_same_v<U, bool>, int> = 0>
    explicit operator bool() const noexcept {
        return has_value();
    }

    /// Returns the value. A failure throws or aborts; see the head of this file.
    T &value() & { return check(), *std::get_if<0>(&content_); }
    const T &value() const & { return check(), *std::get_if<0>(&content_); }
    T value() && { return check(), std::move(*std::get_if<0>(&content_)); }
    T &operator*() & { return value(); }
    const T &operator*() const & { return value(); }
    T operator*() && { return std::move(*this).value(); }
    T *operator->() { return &value(); }
    const T *operator->() const { return &value(); }

    /// Returns the error. It is empty, with the status COLLTRANS_OK, if there is a value.
    colltrans::error error() const {
        if (has_value()) return {COLLTRANS_OK, {}};
        return *std::get_if<1>(&content_);
    }

  private:
    void check() const {
        if (!has_value()) detail::fail(*std::get_if<1>(&content_));
    }

    std::variant<T, colltrans::error> content_;
};

/// Result of a call without a value.
struct nothing {};

namespace detail {

/// Runs a call that writes an answer.
template <class T, class Call>
result<T> answer(Call call) {
    T value{};
    const status code = call(&value);
    if (code != COLLTRANS_OK) return last_error(code);
    return value;
}

template <class T, class = void>
struct is_matrix : std::false_type {};
template <class T>
struct is_matrix<T, std::void_t<decltype(std::declval<const T &>().data()),
                                decltype(std::declval<const T &>().rows()),
                                decltype(std::declval<const T &>().cols())>> : std::true_type {};

template <class T, class = void>
struct is_array : std::false_type {};
template <class T>
struct is_array<T, std::void_t<decltype(std::declval<const T &>().data()),
                               decltype(std::declval<const T &>().size())>>
    : std::bool_constant<!is_matrix<T>::value> {};

/// Whether a matrix is stored by rows. Matrices that do not say are stored by columns.
template <class T, class = void>
struct is_row_major : std::false_type {};
template <class T>
struct is_row_major<T, std::enable_if_t<bool(T::IsRowMajor)>> : std::true_type {};

/// Whether the elements of a matrix have strides, as those of Eigen's blocks and maps.
template <class T, class = void>
struct has_strides : std::false_type {};
template <class T>
struct has_strides<T, std::void_t<decltype(std::declval<const T &>().innerStride()),
                                  decltype(std::declval<const T &>().outerStride())>> : std::true_type {};

/// Whether a type is a transform with a matrix, such as `Eigen::Isometry3d`.
template <class T, class = void>
struct is_transform : std::false_type {};
template <class T>
struct is_transform<T, std::void_t<decltype(std::declval<const T &>().linear()),
                                   decltype(std::declval<const T &>().matrix())>> : std::true_type {};

/// The numbers of rows and columns in the type of a matrix, or -1.
template <class T, class = void>
struct fixed_shape {
    static constexpr int rows = -1, columns = -1;
};
template <class T>
struct fixed_shape<T, std::void_t<decltype(T::RowsAtCompileTime), decltype(T::ColsAtCompileTime)>> {
    static constexpr int rows = int(T::RowsAtCompileTime), columns = int(T::ColsAtCompileTime);
};

/// The type of the elements of a container or a matrix.
template <class T>
using element = std::remove_cv_t<std::remove_pointer_t<decltype(std::declval<const T &>().data())>>;

/// Returns the distances in memory between the rows and between the columns of a matrix, in numbers.
template <class Matrix>
std::array<std::ptrdiff_t, 2> strides(const Matrix &of) {
    constexpr bool by_rows = is_row_major<Matrix>::value;
    auto inner = std::ptrdiff_t{1}, outer = static_cast<std::ptrdiff_t>(by_rows ? of.cols() : of.rows());
    if constexpr (has_strides<Matrix>::value) {
        inner = static_cast<std::ptrdiff_t>(of.innerStride());
        outer = static_cast<std::ptrdiff_t>(of.outerStride());
    }
    return by_rows ? std::array{outer, inner} : std::array{inner, outer};
}

/// Returns a number of a matrix.
template <class Matrix>
double entry(const Matrix &of, std::size_t row, std::size_t column) {
    const auto by = strides(of);
    const auto place = static_cast<std::ptrdiff_t>(row) * by[0] + static_cast<std::ptrdiff_t>(column) * by[1];
    return static_cast<double>(of.data()[place]);
}

}  // namespace detail

/// A view of `size` elements that somebody else owns.
template <class T>
class view {
  public:
    view() = default;
    view(const T *data, std::size_t size) : data_(data), size_(size), is_given_(true) {}
    template <class Container, class = std::enable_if_t<detail::is_array<Container>::value>>
    view(const Container &of) : view(of.data(), static_cast<std::size_t>(of.size())) {}

    const T *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    /// Checks whether the view is of a container, which may be empty.
    bool is_given() const noexcept { return is_given_; }

  private:
    const T *data_ = nullptr;
    std::size_t size_ = 0;
    bool is_given_ = false;
};

/// A view of points or vectors of three numbers of the type double.
///
/// It is built from numbers (three for each point), from structs of three numbers, and from matrices of 3 x N or N x 3
/// numbers. The type of a matrix states which of both it is, or its size does. A matrix of 3 x 3 numbers of a type for
/// any size has its points in columns if it is stored by columns, in rows otherwise. Points that do not lie one after
/// the other in memory are copied. Other shapes give a view without points, which the functions reject.
class points {
  public:
    points() = default;
    points(const double *data, std::size_t count) : data_(data), count_(count), is_given_(true) {}

    template <class Container, std::enable_if_t<detail::is_array<Container>::value, int> = 0>
    points(const Container &of) {
        using element = detail::element<Container>;
        const auto size = static_cast<std::size_t>(of.size());
        if constexpr (std::is_same_v<element, double>) {
            if (size % 3 == 0) *this = points(of.data(), size / 3);
        } else {
            // A nested container has this size as well, but it has a destructor.
            static_assert(sizeof(element) == 3 * sizeof(double) && alignof(element) >= alignof(double) &&
                              std::is_trivially_destructible_v<element>,
                          "a point has three numbers of the type double");
            *this = points(reinterpret_cast<const double *>(of.data()), size);
        }
    }

    template <class Matrix, std::enable_if_t<detail::is_matrix<Matrix>::value, int> = 0>
    points(const Matrix &of) {
        static_assert(std::is_same_v<detail::element<Matrix>, double>, "numbers have the type double");
        using shape = detail::fixed_shape<Matrix>;
        const auto rows = static_cast<std::size_t>(of.rows());
        const auto columns = static_cast<std::size_t>(of.cols());
        if (rows != 3 && columns != 3) return;
        bool in_columns = rows == 3;
        if (rows == 3 && columns == 3) {
            in_columns = shape::rows == shape::columns ? !detail::is_row_major<Matrix>::value : shape::rows == 3;
        }
        const auto by = detail::strides(of);
        if (by[in_columns ? 0 : 1] == 1 && by[in_columns ? 1 : 0] == 3) {
            *this = points(of.data(), in_columns ? columns : rows);
            return;
        }
        copy_ = std::make_shared<std::vector<double>>(rows * columns);
        for (std::size_t k = 0; k < rows * columns; ++k) {
            (*copy_)[k] = in_columns ? detail::entry(of, k % 3, k / 3) : detail::entry(of, k / 3, k % 3);
        }
        data_ = copy_->data();
        count_ = in_columns ? columns : rows;
        is_given_ = true;
    }

    const double *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return count_; }
    /// Checks whether the view is of a table of points, which may be empty.
    bool is_given() const noexcept { return is_given_; }

  private:
    const double *data_ = nullptr;
    std::size_t count_ = 0;
    bool is_given_ = false;
    std::shared_ptr<std::vector<double>> copy_;
};

/// One vector of three numbers: braces, an array, or a matrix of three numbers.
class vector {
  public:
    vector(double x, double y, double z) : numbers_{x, y, z} {}
    template <class Container, std::enable_if_t<detail::is_array<Container>::value, int> = 0>
    vector(const Container &of) {
        using element = detail::element<Container>;
        static_assert(std::is_arithmetic_v<element> && sizeof(element) > 1, "a vector has three numbers");
        static_assert(!std::is_same_v<Container, points>, "a vector is not a table of points");
        if (of.size() != 3) return;
        for (std::size_t k = 0; k < 3; ++k) numbers_[k] = static_cast<double>(of.data()[k]);
    }
    template <class Matrix, std::enable_if_t<detail::is_matrix<Matrix>::value, int> = 0>
    vector(const Matrix &of) {
        const bool is_column = of.rows() == 3 && of.cols() == 1;
        if (!is_column && !(of.rows() == 1 && of.cols() == 3)) return;
        for (std::size_t k = 0; k < 3; ++k) numbers_[k] = detail::entry(of, is_column ? k : 0, is_column ? 0 : k);
    }
    const double *data() const noexcept { return numbers_.data(); }

  private:
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    // A vector of another size is NaN, which the functions reject.
    std::array<double, 3> numbers_{none, none, none};
};

/// A pose: a rotation and a translation. The default is the identity.
class pose : public colltrans_pose {
  public:
    pose() : colltrans_pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}} {}
    pose(const colltrans_pose &of) : colltrans_pose(of) {}
    static pose from_translation(const vector &by) {
        pose made;
        for (std::size_t k = 0; k < 3; ++k) made.translation[k] = by.data()[k];
        return made;
    }
    /// Builds a pose from a quaternion `x, y, z, w` of length 1.
    static result<pose> from_quaternion(const std::array<double, 4> &xyzw, const vector &translation) {
        return detail::answer<pose>([&](pose *made) {
            return colltrans_pose_from_quaternion(xyzw.data(), translation.data(), made);
        });
    }
    /// Builds a pose from a 4 x 4 or 3 x 4 matrix, or from a transform such as `Eigen::Isometry3d`.
    template <class Matrix>
    static result<pose> from_matrix(const Matrix &of) {
        if constexpr (detail::is_transform<Matrix>::value) {
            return from_matrix(of.matrix());
        } else {
            const auto rows = static_cast<std::size_t>(of.rows());
            if (of.cols() != 4 || (rows != 3 && rows != 4)) {
                return error{COLLTRANS_INVALID_ARGUMENT, "matrix: accepted are 4 x 4 and 3 x 4 numbers"};
            }
            std::array<double, 16> numbers{};
            numbers[15] = 1;
            for (std::size_t row = 0; row < rows; ++row) {
                for (std::size_t column = 0; column < 4; ++column) {
                    numbers[4 * column + row] = detail::entry(of, row, column);
                }
            }
            return detail::answer<pose>(
                [&](pose *made) { return colltrans_pose_from_matrix(numbers.data(), made); });
        }
    }
};

/// The text of a proof, as JSON.
using proof = std::string;

namespace detail {

template <class Handle, void (*Free)(Handle *)>
struct deleter {
    void operator()(Handle *handle) const noexcept { Free(handle); }
};

template <class Handle, void (*Free)(Handle *)>
using owner = std::unique_ptr<Handle, deleter<Handle, Free>>;

/// Runs a call that writes a handle, and builds its owner.
template <class Owner, class Handle, class Call>
result<Owner> own(Call call) {
    Handle *handle = nullptr;
    const status code = call(&handle);
    if (code != COLLTRANS_OK) return last_error(code);
    return Owner(handle);
}

/// Runs a call that writes a text.
template <class Call>
result<std::string> text(Call call) {
    const char *written = nullptr;
    const status code = call(&written);
    if (code != COLLTRANS_OK) return last_error(code);
    const owner<const char, colltrans_text_free> kept(written);
    return std::string(written);
}

}  // namespace detail

/// A convex body or a solid.
class body {
  public:
    /// Takes ownership of a handle.
    explicit body(colltrans_body *handle) : handle_(handle) {}

    /// Builds the convex hull of points.
    static result<body> convex(const points &of) {
        return make([&](auto out) { return colltrans_convex_from_points(of.data(), of.size(), out); });
    }
    /// Builds the box between two corners.
    static result<body> cuboid(const vector &low, const vector &high) {
        return make([&](auto out) { return colltrans_convex_cuboid(low.data(), high.data(), out); });
    }
    /// Builds the hull of a closed convex mesh of triangles, three indices each.
    static result<body> convex_mesh(const points &vertices, view<std::uint32_t> triangles, double tolerance = 0) {
        if (triangles.size() % 3 != 0) return bad_triangles();
        return make([&](auto out) {
            return colltrans_convex_from_mesh(vertices.data(), vertices.size(), triangles.data(), nullptr,
                                              triangles.size() / 3, tolerance, out);
        });
    }
    /// Builds the hull of a closed convex mesh of polygons: the indices of all faces, and the number of vertices of
    /// each face.
    static result<body> convex_mesh(const points &vertices, view<std::uint32_t> indices, view<std::uint32_t> sizes,
                                    double tolerance = 0) {
        if (!fits(indices, sizes)) return bad_polygons();
        return make([&](auto out) {
            return colltrans_convex_from_mesh(vertices.data(), vertices.size(), indices.data(), sizes.data(),
                                              sizes.size(), tolerance, out);
        });
    }
    /// Builds a solid from triangles, three indices each.
    static result<body> solid(const points &vertices, view<std::uint32_t> triangles, bool is_open = false) {
        if (triangles.size() % 3 != 0) return bad_triangles();
        return make([&](auto out) {
            return colltrans_solid_from_mesh(vertices.data(), vertices.size(), triangles.data(), nullptr,
                                             triangles.size() / 3, is_open, out);
        });
    }
    /// Builds a solid from polygons: the indices of all faces, and the number of vertices of each face.
    static result<body> solid(const points &vertices, view<std::uint32_t> indices, view<std::uint32_t> sizes,
                              bool is_open = false) {
        if (!fits(indices, sizes)) return bad_polygons();
        return make([&](auto out) {
            return colltrans_solid_from_mesh(vertices.data(), vertices.size(), indices.data(), sizes.data(),
                                             sizes.size(), is_open, out);
        });
    }
    /// Builds the union of bodies.
    static result<body> pieces(const std::vector<const body *> &of) {
        std::vector<const colltrans_body *> handles;
        for (const body *piece : of) handles.push_back(piece == nullptr ? nullptr : piece->get());
        return make([&](auto out) { return colltrans_solid_from_pieces(handles.data(), handles.size(), out); });
    }
    /// Builds the body of all points within a radius of this one.
    result<body> rounded(double radius) const {
        return make([&](auto out) { return colltrans_body_rounded(get(), radius, out); });
    }
    /// Builds another handle of the same body, which shares its memory.
    result<body> clone() const {
        return make([&](auto out) { return colltrans_body_clone(get(), out); });
    }
    result<body_properties> info() const {
        return detail::answer<body_properties>([&](auto out) { return colltrans_body_info(get(), out); });
    }
    const colltrans_body *get() const noexcept { return handle_.get(); }

  private:
    template <class Call>
    static result<body> make(Call call) {
        return detail::own<body, colltrans_body>(call);
    }
    /// Checks whether the sizes of the faces add up to the number of indices.
    static bool fits(view<std::uint32_t> indices, view<std::uint32_t> sizes) {
        std::uint64_t total = 0;
        for (std::size_t k = 0; k < sizes.size(); ++k) total += sizes.data()[k];
        return total == indices.size();
    }
    static error bad_polygons() {
        return {COLLTRANS_INVALID_ARGUMENT, "sizes: their sum is not the number of indices"};
    }
    static error bad_triangles() {
        return {COLLTRANS_INVALID_ARGUMENT, "triangles: the number of indices is not a multiple of 3"};
    }
    detail::owner<colltrans_body, colltrans_body_free> handle_;
};

/// Finds the first translation at which the bodies meet.
inline result<cast_answer> first_contact(const body &moving, const pose &moving_pose, const body &fixed,
                                         const pose &fixed_pose, const vector &direction,
                                         const cast_options &options = {}) {
    return detail::answer<cast_answer>([&](auto out) {
        return colltrans_first_contact(moving.get(), &moving_pose, fixed.get(), &fixed_pose, direction.data(),
                                       &options, out);
    });
}

/// Finds the first and the last contact.
inline result<cast_answer> contact_range(const body &moving, const pose &moving_pose, const body &fixed,
                                         const pose &fixed_pose, const vector &direction,
                                         const cast_options &options = {}) {
    return detail::answer<cast_answer>([&](auto out) {
        return colltrans_contact_range(moving.get(), &moving_pose, fixed.get(), &fixed_pose, direction.data(),
                                       &options, out);
    });
}

/// Finds how far the moving body can move.
inline result<cast_answer> clearance(const body &moving, const pose &moving_pose, const body &fixed,
                                     const pose &fixed_pose, const vector &direction,
                                     const cast_options &options = {}) {
    return detail::answer<cast_answer>([&](auto out) {
        return colltrans_clearance(moving.get(), &moving_pose, fixed.get(), &fixed_pose, direction.data(), &options,
                                   out);
    });
}

/// Checks whether the bodies have a common point: `*intersects(...)`.
inline result<bool> intersects(const body &moving, const pose &moving_pose, const body &fixed,
                               const pose &fixed_pose, const cast_options &options = {}) {
    std::uint32_t meets = 0;
    const status code =
        colltrans_intersects(moving.get(), &moving_pose, fixed.get(), &fixed_pose, &options, &meets);
    if (code != COLLTRANS_OK) return detail::last_error(code);
    return meets != 0;
}

/// Computes the distance of the bodies and their nearest points.
inline result<distance_answer> distance(const body &moving, const pose &moving_pose, const body &fixed,
                                        const pose &fixed_pose) {
    return detail::answer<distance_answer>([&](auto out) {
        return colltrans_distance(moving.get(), &moving_pose, fixed.get(), &fixed_pose, out);
    });
}

/// Computes the bounds of the distance alone.
inline result<std::array<double, 2>> distance_bounds(const body &moving, const pose &moving_pose,
                                                     const body &fixed, const pose &fixed_pose) {
    return detail::answer<std::array<double, 2>>([&](auto out) {
        return colltrans_distance_bounds(moving.get(), &moving_pose, fixed.get(), &fixed_pose, out->data());
    });
}

/// Decides whether the bodies are closer than a length.
inline result<distance_answer> within(const body &moving, const pose &moving_pose, const body &fixed,
                                      const pose &fixed_pose, double length) {
    return detail::answer<distance_answer>([&](auto out) {
        return colltrans_within(moving.get(), &moving_pose, fixed.get(), &fixed_pose, length, out);
    });
}

/// Computes the shortest translation that separates convex bodies, or the least tolerance of solids.
inline result<depth_answer> depth(const body &moving, const pose &moving_pose, const body &fixed,
                                  const pose &fixed_pose) {
    return detail::answer<depth_answer>([&](auto out) {
        return colltrans_depth(moving.get(), &moving_pose, fixed.get(), &fixed_pose, out);
    });
}

/// A sequence of similar queries about convex bodies. Each thread needs a tracker of its own.
class tracker {
  public:
    static result<tracker> make() { return detail::own<tracker, colltrans_tracker>(colltrans_tracker_new); }
    explicit tracker(colltrans_tracker *handle) : handle_(handle) {}

    result<cast_answer> first_contact(const body &moving, const pose &moving_pose, const body &fixed,
                                      const pose &fixed_pose, const vector &direction,
                                      const cast_options &options = {}) {
        return detail::answer<cast_answer>([&](auto out) {
            return colltrans_tracker_first_contact(handle_.get(), moving.get(), &moving_pose, fixed.get(),
                                                   &fixed_pose, direction.data(), &options, out);
        });
    }
    result<cast_answer> contact_range(const body &moving, const pose &moving_pose, const body &fixed,
                                      const pose &fixed_pose, const vector &direction,
                                      const cast_options &options = {}) {
        return detail::answer<cast_answer>([&](auto out) {
            return colltrans_tracker_contact_range(handle_.get(), moving.get(), &moving_pose, fixed.get(),
                                                   &fixed_pose, direction.data(), &options, out);
        });
    }
    result<cast_answer> clearance(const body &moving, const pose &moving_pose, const body &fixed,
                                  const pose &fixed_pose, const vector &direction,
                                  const cast_options &options = {}) {
        return detail::answer<cast_answer>([&](auto out) {
            return colltrans_tracker_clearance(handle_.get(), moving.get(), &moving_pose, fixed.get(), &fixed_pose,
                                               direction.data(), &options, out);
        });
    }
    result<distance_answer> distance(const body &moving, const pose &moving_pose, const body &fixed,
                                     const pose &fixed_pose) {
        return detail::answer<distance_answer>([&](auto out) {
            return colltrans_tracker_distance(handle_.get(), moving.get(), &moving_pose, fixed.get(), &fixed_pose,
                                              out);
        });
    }
    /// Discards the last answer.
    void reset() { (void)colltrans_tracker_reset(handle_.get()); }

  private:
    detail::owner<colltrans_tracker, colltrans_tracker_free> handle_;
};

/// The pose of a body at all times from 0 to 1.
class motion {
  public:
    explicit motion(colltrans_motion *handle) : handle_(handle) {}

    static result<motion> rest(const pose &at) {
        return make([&](auto out) { return colltrans_motion_rest(&at, out); });
    }
    static result<motion> translation(const pose &from, const vector &displacement) {
        return make([&](auto out) { return colltrans_motion_translation(&from, displacement.data(), out); });
    }
    /// Builds a rotation about an axis through a point, with a translation by `rise` along the axis.
    static result<motion> screw(const pose &from, const vector &point, const vector &axis, double angle,
                                double rise = 0) {
        return make([&](auto out) {
            return colltrans_motion_screw(&from, point.data(), axis.data(), angle, rise, out);
        });
    }
    static result<motion> free_flight(const pose &from, const vector &center, const vector &velocity,
                                      const vector &angular_velocity) {
        return make([&](auto out) {
            return colltrans_motion_free_flight(&from, center.data(), velocity.data(), angular_velocity.data(), out);
        });
    }
    static result<motion> through(view<pose> poses) {
        static_assert(sizeof(pose) == sizeof(colltrans_pose), "poses are passed as an array");
        return make([&](auto out) { return colltrans_motion_through_poses(poses.data(), poses.size(), out); });
    }
    result<pose> pose_at(double time) const {
        return detail::answer<pose>([&](pose *out) { return colltrans_motion_pose_at(get(), time, out); });
    }
    const colltrans_motion *get() const noexcept { return handle_.get(); }

  private:
    template <class Call>
    static result<motion> make(Call call) {
        return detail::own<motion, colltrans_motion>(call);
    }
    detail::owner<colltrans_motion, colltrans_motion_free> handle_;
};

/// Finds the first time at which the bodies meet along their motions.
inline result<motion_answer> first_contact(const body &moving, const motion &moving_motion, const body &fixed,
                                           const motion &fixed_motion, const cast_options &options = {}) {
    return detail::answer<motion_answer>([&](auto out) {
        return colltrans_motion_first_contact(moving.get(), moving_motion.get(), fixed.get(), fixed_motion.get(),
                                              &options, out);
    });
}

/// Finds how far the bodies can move along their motions.
inline result<motion_answer> clearance(const body &moving, const motion &moving_motion, const body &fixed,
                                       const motion &fixed_motion, const cast_options &options = {}) {
    return detail::answer<motion_answer>([&](auto out) {
        return colltrans_motion_clearance(moving.get(), moving_motion.get(), fixed.get(), fixed_motion.get(),
                                          &options, out);
    });
}

/// An answer about one obstacle of a scene; COLLTRANS_NO_OBSTACLE if there is none.
template <class Answer>
struct of_obstacle {
    std::uint64_t obstacle = COLLTRANS_NO_OBSTACLE;
    Answer answer{};
};

/// Obstacles that are closer than a length, and those that rounding cannot decide.
struct nearby {
    std::vector<std::uint64_t> closer, undecided;
};

/// Placed bodies, the obstacles of a moving body.
class scene {
  public:
    static result<scene> make() { return detail::own<scene, colltrans_scene>(colltrans_scene_new); }
    explicit scene(colltrans_scene *handle) : handle_(handle) {}

    /// Inserts a body, and returns the number of the obstacle.
    result<std::uint64_t> insert(const body &of, const pose &at) {
        return detail::answer<std::uint64_t>(
            [&](auto out) { return colltrans_scene_insert(handle_.get(), of.get(), &at, out); });
    }
    result<nothing> set_pose(std::uint64_t obstacle, const pose &at) {
        return done(colltrans_scene_set_pose(handle_.get(), obstacle, &at));
    }
    result<nothing> remove(std::uint64_t obstacle) { return done(colltrans_scene_remove(handle_.get(), obstacle)); }
    std::size_t size() const {
        std::size_t count = 0;
        (void)colltrans_scene_size(get(), &count);
        return count;
    }
    result<of_obstacle<distance_answer>> nearest(const body &of, const pose &at,
                                                 view<std::uint64_t> ignored = {}) const {
        return detail::answer<of_obstacle<distance_answer>>([&](auto out) {
            return colltrans_scene_nearest(get(), of.get(), &at, ignored.data(), ignored.size(), &out->obstacle,
                                           &out->answer);
        });
    }
    result<nearby> within(const body &of, const pose &at, double length, view<std::uint64_t> ignored = {}) const {
        std::vector<std::uint64_t> numbers(size());
        std::size_t closer = 0, undecided = 0;
        const status code =
            colltrans_scene_within(get(), of.get(), &at, length, ignored.data(), ignored.size(), numbers.data(),
                                   numbers.size(), &closer, &undecided);
        if (code != COLLTRANS_OK) return detail::last_error(code);
        const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(closer);
        return nearby{{numbers.begin(), middle}, {middle, middle + static_cast<std::ptrdiff_t>(undecided)}};
    }
    result<of_obstacle<cast_answer>> clearance(const body &of, const pose &at, const vector &direction,
                                               const cast_options &options = {},
                                               view<std::uint64_t> ignored = {}) const {
        return detail::answer<of_obstacle<cast_answer>>([&](auto out) {
            return colltrans_scene_clearance(get(), of.get(), &at, direction.data(), &options, ignored.data(),
                                             ignored.size(), &out->obstacle, &out->answer);
        });
    }
    result<proof> nearest_proof(const body &of, const pose &at, view<std::uint64_t> ignored = {}) const {
        return detail::text([&](auto out) {
            return colltrans_scene_nearest_proof(get(), of.get(), &at, ignored.data(), ignored.size(), out);
        });
    }
    result<proof> clearance_proof(const body &of, const pose &at, const vector &direction,
                                  const cast_options &options = {}, view<std::uint64_t> ignored = {}) const {
        return detail::text([&](auto out) {
            return colltrans_scene_clearance_proof(get(), of.get(), &at, direction.data(), &options, ignored.data(),
                                                   ignored.size(), out);
        });
    }
    const colltrans_scene *get() const noexcept { return handle_.get(); }

  private:
    static result<nothing> done(status code) {
        if (code != COLLTRANS_OK) return detail::last_error(code);
        return nothing{};
    }
    detail::owner<colltrans_scene, colltrans_scene_free> handle_;
};

/// Rows of a table of queries. Poses and directions are one for each row, or one for all; no poses are the identity.
/// The tables are views, so what they view must outlive this struct.
struct rows {
    view<pose> moving_poses, fixed_poses;
    points directions;
    /// Number of rows. Without it, the longest table gives the number; an empty table makes it 0.
    std::optional<std::size_t> count;
    std::uint32_t threads = 0;

    /// Returns the number of rows.
    std::size_t size() const {
        if (count) return *count;
        std::size_t longest = 0;
        bool has_empty = false;
        const auto include = [&](const auto &table) {
            if (table.size() > longest) longest = table.size();
            has_empty |= table.is_given() && table.size() == 0;
        };
        include(moving_poses);
        include(fixed_poses);
        include(directions);
        return has_empty ? 0 : longest;
    }
    /// Returns the rows as the C interface takes them.
    colltrans_rows get() const {
        return {size(), moving_poses.data(), moving_poses.size(), fixed_poses.data(), fixed_poses.size(),
                directions.data(), directions.size(), threads};
    }
};

namespace detail {

inline result<nothing> cast_many(status (*query)(const colltrans_body *, const colltrans_body *,
                                                 const colltrans_rows *, const colltrans_cast_options *,
                                                 const colltrans_cast_columns *),
                                 const body &moving, const body &fixed, const rows &of,
                                 const cast_columns &columns, const cast_options &options) {
    if (!of.directions.is_given()) {
        return error{COLLTRANS_INVALID_ARGUMENT, "rows.directions: accepted are vectors of three numbers"};
    }
    const colltrans_rows table = of.get();
    const status code = query(moving.get(), fixed.get(), &table, &options, &columns);
    if (code != COLLTRANS_OK) return last_error(code);
    return nothing{};
}

}  // namespace detail

/// Finds the first contact of each row, and writes the columns that are not null. Each has room for `of.size()` rows.
inline result<nothing> first_contact_many(const body &moving, const body &fixed, const rows &of,
                                          const cast_columns &columns, const cast_options &options = {}) {
    return detail::cast_many(colltrans_first_contact_many, moving, fixed, of, columns, options);
}

/// Finds the first and the last contact of each row.
inline result<nothing> contact_range_many(const body &moving, const body &fixed, const rows &of,
                                          const cast_columns &columns, const cast_options &options = {}) {
    return detail::cast_many(colltrans_contact_range_many, moving, fixed, of, columns, options);
}

/// Finds the clearance of each row.
inline result<nothing> clearance_many(const body &moving, const body &fixed, const rows &of,
                                      const cast_columns &columns, const cast_options &options = {}) {
    return detail::cast_many(colltrans_clearance_many, moving, fixed, of, columns, options);
}

/// Computes the distance of each row.
inline result<nothing> distance_many(const body &moving, const body &fixed, const rows &of,
                                     const distance_columns &columns) {
    const colltrans_rows table = of.get();
    const status code = colltrans_distance_many(moving.get(), fixed.get(), &table, &columns);
    if (code != COLLTRANS_OK) return detail::last_error(code);
    return nothing{};
}

/// Proves `first_contact` of convex bodies.
inline result<proof> first_contact_proof(const body &moving, const pose &moving_pose, const body &fixed,
                                         const pose &fixed_pose, const vector &direction,
                                         const cast_options &options = {}) {
    return detail::text([&](auto out) {
        return colltrans_first_contact_proof(moving.get(), &moving_pose, fixed.get(), &fixed_pose, direction.data(),
                                             &options, out);
    });
}

/// Proves `clearance`.
inline result<proof> clearance_proof(const body &moving, const pose &moving_pose, const body &fixed,
                                     const pose &fixed_pose, const vector &direction,
                                     const cast_options &options = {}) {
    return detail::text([&](auto out) {
        return colltrans_clearance_proof(moving.get(), &moving_pose, fixed.get(), &fixed_pose, direction.data(),
                                         &options, out);
    });
}

/// Proves `distance`.
inline result<proof> distance_proof(const body &moving, const pose &moving_pose, const body &fixed,
                                    const pose &fixed_pose) {
    return detail::text([&](auto out) {
        return colltrans_distance_proof(moving.get(), &moving_pose, fixed.get(), &fixed_pose, out);
    });
}

/// Proves `within`.
inline result<proof> within_proof(const body &moving, const pose &moving_pose, const body &fixed,
                                  const pose &fixed_pose, double length) {
    return detail::text([&](auto out) {
        return colltrans_within_proof(moving.get(), &moving_pose, fixed.get(), &fixed_pose, length, out);
    });
}

/// Proves the depth. For solids the bounds of the proof may be farther apart than those of `depth`.
inline result<proof> depth_proof(const body &moving, const pose &moving_pose, const body &fixed,
                                 const pose &fixed_pose) {
    return detail::text([&](auto out) {
        return colltrans_depth_proof(moving.get(), &moving_pose, fixed.get(), &fixed_pose, out);
    });
}

/// Proves how much of the bodies overlaps: bounds of the volume of their common part, its box, and how the bodies lie to
/// each other. The bounds differ by at most `accuracy`, a share of the lower one, unless the search ends before.
inline result<proof> common_part_proof(const body &moving, const pose &moving_pose, const body &fixed,
                                       const pose &fixed_pose, double accuracy = 0.01) {
    return detail::text([&](auto out) {
        return colltrans_common_part_proof(moving.get(), &moving_pose, fixed.get(), &fixed_pose, accuracy, out);
    });
}

/// Proves `first_contact` along motions.
inline result<proof> first_contact_proof(const body &moving, const motion &moving_motion, const body &fixed,
                                         const motion &fixed_motion, const cast_options &options = {}) {
    return detail::text([&](auto out) {
        return colltrans_motion_proof(moving.get(), moving_motion.get(), fixed.get(), fixed_motion.get(), &options,
                                      out);
    });
}

/// Checks a proof without a search, and returns the proven statement in words.
inline result<std::string> check_proof(std::string_view json) {
    return detail::text([&](auto out) { return colltrans_check_proof(json.data(), json.size(), out); });
}

/// Checks that the header and the library have the same binary interface.
inline bool is_compatible() { return colltrans_abi() == COLLTRANS_ABI; }

}  // namespace throwing or aborting
}  // namespace colltrans

#endif
