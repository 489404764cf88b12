// Two files of one program: the first one throws, the second one aborts. programs.rs compiles this file as both.
#ifdef THROWING
#define COLLTRANS_EXCEPTIONS
#endif
#include <colltrans.hpp>

bool is_made(double x);

#ifdef THROWING
int main() {
    try {
        (void)*colltrans::body::cuboid({0, 0, 0}, {1, 1, std::numeric_limits<double>::quiet_NaN()});
    } catch (const colltrans::exception &) {
        return is_made(1) ? 0 : 1;
    }
    return 2;
}
#else
bool is_made(double x) {
    const colltrans::body cube = *colltrans::body::cuboid({0, 0, 0}, {1, 1, x});
    return cube.get() != nullptr;
}
#endif
