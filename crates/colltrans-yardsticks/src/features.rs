//! Vertices, edges and faces with their neighbours.
