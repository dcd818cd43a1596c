//! Mesh and flow as one nonlinear problem per slab, and the march from slab to slab
