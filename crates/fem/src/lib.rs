//! Space-time slab spaces and the kernels of a conservation law on a moving mesh
