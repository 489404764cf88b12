"""Answers, and the parts of them: contacts, features, proofs.

Each answer is a frozen object. ``match`` distinguishes its cases, ``query`` is its query,
``to_dict()`` has its fields, and ``proof_json()`` and ``save_proof(path)`` write its proof.

**The number of an answer.** An answer that is a number has ``value``, the best estimate, and the
proven bounds ``lower`` and ``upper``. ``float(answer)`` is its value, and ``<``, ``<=``, ``>``,
``>=``, ``==`` and ``!=`` compare this value with numbers; ``min(answers)`` and ``sorted(answers)``
order by it. Two answers are equal only if they are the same object.

=====================================  =================================================
answer                                 ``value``
=====================================  =================================================
Contact, SolidContact, LastContact     the translation
Grazing                                the translation, if the overlap is real
ContactRange                           the first translation
Blocked, SolidBlocked                  the free travel, rounded down: ``distance``
Separated, Slides, Behind, SolidFree   infinite: the bodies never meet, nothing blocks
Overlapping, SolidOverlapping          None: bodies that overlap have no free travel
DirectionalDepth                       the travel backwards, rounded up: ``depth``
Distance, Depth, OverlapDepth          the middle of both bounds
FirstContact, PathContact              the time; infinite if the bodies never meet, None
                                       if the answer is undecided
MotionClearance                        the time until which the body can move, 1 for all
                                       of the motion; None if the bodies overlap
NearestObstacle, ObstacleClearance     those of a distance and of a clearance
=====================================  =================================================

If ``value`` is None, ``float`` and ``<`` raise a TypeError, and no number is equal to the answer.
Intersection and Within are no numbers: they convert to a bool. ``bool(within)`` is False only if
the distance is proven to exceed the length; ``closer`` is None in the undecided case, in which the
length lies between the bounds of the distance.

In columns, NaN stands for None, and ``value``, ``lower`` and ``upper`` of a row are those of its
single answer. Proofs of :class:`SolidContact` and :class:`SolidFree` are those of the clearance.

>>> from colltrans import ConvexPolyhedron, clearance
>>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
>>> down = clearance(cube.at([0, 0, 4]), cube, [0, 0, -1])
>>> up = clearance(cube.at([0, 0, 4]), cube, [0, 0, 1])
>>> down < 3.5 < up, float(up), round(min(down, up).value, 9)
(True, inf, 3.0)
"""

from colltrans._colltrans import (
    Behind,
    Blocked,
    Certificate,
    Contact,
    ContactRange,
    Depth,
    DirectionalDepth,
    Distance,
    Feature,
    Features,
    FirstContact,
    Grazing,
    Intersection,
    LastContact,
    OffsetReport,
    OverlapDepth,
    Overlapping,
    Separated,
    Separation,
    ShrinkReport,
    Slides,
    SolidBlocked,
    SolidCertificate,
    SolidContact,
    SolidFree,
    SolidOverlapping,
    Steps,
    Within,
)

__all__ = [
    "Behind",
    "Blocked",
    "Certificate",
    "Contact",
    "ContactRange",
    "Depth",
    "DirectionalDepth",
    "Distance",
    "Feature",
    "Features",
    "FirstContact",
    "Grazing",
    "Intersection",
    "LastContact",
    "OffsetReport",
    "OverlapDepth",
    "Overlapping",
    "Separated",
    "Separation",
    "ShrinkReport",
    "Slides",
    "SolidBlocked",
    "SolidCertificate",
    "SolidContact",
    "SolidFree",
    "SolidOverlapping",
    "Steps",
    "Within",
]
