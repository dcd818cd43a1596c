//! Lists of other readers: the same mesh as from Gmsh, or an error that names the place.

use super::{SQUARE_2, read};
use crate::{ListedElement, Mesh, MeshLists, Numbers, Shape, Simplices, Span};

/// The rectangle of [`SQUARE_2`] with its four sides; nodes are counted row by row.
fn square() -> MeshLists {
    let element =
        |shape, nodes: &[usize], name| ListedElement { shape, degree: 1, nodes: nodes.to_vec(), names: vec![name] };
    let side = |nodes: [usize; 2]| element(Shape::Line, &nodes, 1);
    let cell = element(Shape::Quadrilateral, &[0, 1, 2, 3], 0);
    MeshLists {
        nodes: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0]],
        elements: vec![cell, side([0, 1]), side([1, 3]), side([3, 2]), side([2, 0])],
        names: vec!["gas".into(), "wall".into()],
        node_places: vec![Span { first: 0, label: "node".into(), numbers: Numbers::Lattice(vec![2, 2]) }],
        element_places: vec![
            Span { first: 0, label: "cell".into(), numbers: Numbers::From(5) },
            Span { first: 1, label: "side".into(), numbers: Numbers::From(1) },
        ],
    }
}

/// The message for the rectangle that `change` changes.
fn message(change: impl FnOnce(&mut MeshLists)) -> String {
    let mut lists = square();
    change(&mut lists);
    Mesh::<2>::from_lists(lists, &[], Simplices::Refuse).unwrap_err().to_string()
}

#[test]
fn nodes_are_in_the_order_of_reference_coordinates() {
    let mesh = Mesh::<2>::from_lists(square(), &[], Simplices::Refuse).unwrap();
    assert_eq!(mesh.coordinates(), read(SQUARE_2).unwrap().coordinates());
    assert_eq!((mesh.boundary_names(), mesh.regions()[0].name.as_str()), (&["wall".to_owned()][..], "gas"));
}

#[test]
fn messages_name_the_place() {
    let cases = [
        (message(|lists| lists.elements[0].nodes = vec![0, 1, 3]), "cell 5: it has 3 nodes, expected 4"),
        (message(|lists| lists.elements[0].nodes[1] = 9), "cell 5: node (2, 1) is not among the nodes of the file"),
        (
            message(|lists| lists.elements[0].degree = 11),
            "cell 5: Quadrilateral elements of degree 11 are not supported",
        ),
        (
            message(|lists| lists.elements[2].nodes = vec![1, 2]),
            "side 2: the element of boundary \"wall\" is not a face",
        ),
        (
            message(|lists| lists.nodes[3][2] = 1.0),
            "node (2, 2): z = 1, other nodes have 0: the file has surfaces that do not lie in one plane, and no volumes",
        ),
        (
            message(|lists| lists.nodes.iter_mut().for_each(|x| x[2] = x[1])),
            "node (2, 2): z = 1, other nodes have 0: a mesh in two dimensions has constant z: rotate its plane",
        ),
        (message(|lists| drop(lists.elements.pop())), "cell 5: face 0 of cell 0"),
        (
            message(|lists| {
                lists.names.push("lid".into());
                lists.elements.push(ListedElement { names: vec![2], ..lists.elements[2].clone() });
            }),
            "cell 5: face 1 of cell 0 is listed in boundary \"wall\" and in boundary \"lid\": leave it in one boundary condition",
        ),
        (message(|lists| lists.elements.clear()), "the file has 0 elements of surfaces"),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with(expected), "{expected}: {message}");
    }
}
