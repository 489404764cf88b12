//! V-Clip (Mirtich 1998).
