//! GJK ray cast (van den Bergen 2004).
