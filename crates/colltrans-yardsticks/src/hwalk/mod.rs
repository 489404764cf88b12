//! H-Walk (Guibas, Hsu, Zhang 1999).
