//! One-dimensional nodes, quadrature and polynomials, and their tensor products by sum factorisation
