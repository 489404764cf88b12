//! Enhanced GJK (Cameron 1997).
