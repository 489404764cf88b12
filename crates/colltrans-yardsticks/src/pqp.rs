//! PQP (Larsen, Gottschalk, Lin, Manocha 1999).
