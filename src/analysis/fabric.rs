//! Which way contacts point.

use nalgebra::{DMatrix, SMatrix};

use crate::analysis::Contact;
use crate::particle::Vector;

/// The fabric tensor of some contacts, F = ⟨n ⊗ n⟩ with n along their normals.
#[derive(Clone, Debug, PartialEq)]
pub struct Fabric<const D: usize> {
    /// How many contacts it is of.
    pub contacts: usize,
    /// F; its trace is 1.
    pub tensor: SMatrix<f64, D, D>,
    /// √(D/(D − 1)) ‖F − I/D‖: 0 where all directions are alike, 1 where all
    /// contacts point one way. The norm is the root of the sum of squares.
    pub anisotropy: f64,
    /// The eigenvalues of F, the greatest first.
    pub eigenvalues: Vector<D>,
    /// The direction that belongs to the greatest, of unit length; its last
    /// component that is not 0 is positive.
    pub principal: Vector<D>,
}

/// The fabric tensor of these contacts; `None` if there are none.
///
/// By chance alone the anisotropy of n contacts in random directions is about
/// 1/√n: the mean of its square is 1/n.
#[must_use]
pub fn fabric<'a, const D: usize>(
    contacts: impl IntoIterator<Item = &'a Contact<D>>,
) -> Option<Fabric<D>> {
    let mut tensor = SMatrix::<f64, D, D>::zeros();
    let mut count = 0;
    for contact in contacts {
        tensor += contact.normal * contact.normal.transpose();
        count += 1;
    }
    if count == 0 {
        return None;
    }
    tensor /= count as f64;
    let rest = tensor - SMatrix::identity() / D as f64;
    let scale = if D > 1 {
        D as f64 / (D as f64 - 1.0)
    } else {
        0.0
    };
    let dynamic = DMatrix::from_iterator(D, D, tensor.iter().copied());
    let split = dynamic.symmetric_eigen();
    let mut order: Vec<usize> = (0..D).collect();
    order.sort_by(|&a, &b| split.eigenvalues[b].total_cmp(&split.eigenvalues[a]));
    let first = split.eigenvectors.column(order[0]);
    let sign = first.iter().rev().find(|part| part.abs() > 1.0e-12);
    let sign = sign.copied().unwrap_or(1.0).signum();
    Some(Fabric {
        contacts: count,
        tensor,
        anisotropy: (scale * rest.norm_squared()).sqrt(),
        eigenvalues: Vector::from_fn(|number, _| split.eigenvalues[order[number]]),
        principal: Vector::from_fn(|axis, _| sign * first[axis]),
    })
}
