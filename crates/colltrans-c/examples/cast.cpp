// Moves a box towards a floor: first contact, clearance with a gap, and what an error looks like.
#include <cstdio>

#include <colltrans.hpp>

namespace ct = colltrans;

int main() {
    const ct::body parcel = *ct::body::cuboid({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
    const ct::body floor = *ct::body::cuboid({-50, -50, -1}, {50, 50, 1});
    const ct::pose start = *ct::pose::from_quaternion({0.6, 0, 0, 0.8}, {0, 0, 10});

    ct::cast_options options{};
    options.features = 1;
    const auto contact = ct::first_contact(parcel, start, floor, {}, {0, 0, -1}, options);
    if (!contact) {
        std::fprintf(stderr, "%s\n", contact.error().message.c_str());
        return 1;
    }
    std::printf("falls %.9g, proven: %.9g to %.9g\n", contact->translation, contact->translation_lower,
                contact->translation_upper);
    std::printf("an edge of the parcel: %s\n", contact->moving_feature.kind == COLLTRANS_EDGE ? "yes" : "no");

    options.min_gap = 0.25;
    std::printf("to a gap of 0.25: %.9g\n", ct::clearance(parcel, start, floor, {}, {0, 0, -1}, options)->distance);

    const auto rejected = ct::first_contact(parcel, start, floor, {}, {0, 0, 0});
    std::printf("error: %s\n", rejected.error().message.c_str());
}
