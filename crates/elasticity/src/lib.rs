//! Linear elasticity that moves the mesh: stiffness models, matrix-free operator, preconditioners
