//! Topology and curved geometry of quadrilateral and hexahedral meshes
