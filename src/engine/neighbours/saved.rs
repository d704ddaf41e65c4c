//! Neighbour lists that are saved and made again as they were.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::engine::cells::{Cells, Found, SavedCells};
use crate::engine::neighbours::{Neighbours, Tie};
use crate::model::Boundary;
use crate::particle::Vector;

/// No neighbour is more periods away than this.
const FARTHEST: u32 = 1 << 30;

/// What the lists are made again from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub(in crate::engine) struct SavedNeighbours<const D: usize> {
    cells: SavedCells<D>,
    ties: Vec<SavedTie<D>>,
    largest: f64,
    longest: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
struct SavedTie<const D: usize> {
    anchor: Vector<D>,
    leash: f64,
    lonely: bool,
    /// Who is listed, how many periods away.
    list: Vec<(u32, SVector<i32, D>)>,
}

impl<const D: usize> Neighbours<D> {
    pub(in crate::engine) fn save(&self) -> SavedNeighbours<D> {
        let of = |(particle, tie): (usize, &Tie<D>)| SavedTie {
            anchor: *self.anchor(particle as u32),
            leash: tie.leash,
            lonely: tie.lonely,
            list: tie
                .list
                .iter()
                .map(|found| (found.particle, SVector::from(found.turns)))
                .collect(),
        };
        SavedNeighbours {
            cells: self.cells.save(),
            ties: self.ties.iter().enumerate().map(of).collect(),
            largest: self.largest,
            longest: self.longest,
        }
    }

    /// The lists of `count` grains that were saved. `radius_of` gives their
    /// radii, in d, on a grid for this largest diameter.
    ///
    /// # Errors
    ///
    /// Says what does not fit.
    pub(in crate::engine) fn restore<B: Boundary<D>>(
        boundary: &B,
        saved: &SavedNeighbours<D>,
        count: usize,
        radius_of: impl Fn(f64, u32) -> f64,
    ) -> Result<Self, &'static str> {
        let positive = |length: f64| length > 0.0 && length.is_finite();
        if saved.ties.len() != count || !positive(saved.largest) || !positive(saved.longest) {
            return Err("the lists are not those of these grains");
        }
        let mut ties = Vec::with_capacity(count);
        for (particle, tie) in saved.ties.iter().enumerate() {
            if !(tie.leash >= 0.0 && tie.leash.is_finite())
                || tie.anchor.iter().any(|x| !x.is_finite())
            {
                return Err("a leash has no length");
            }
            let mut list = Vec::with_capacity(tie.list.len());
            for (other, turns) in &tie.list {
                let is_there = (*other as usize) < count && *other as usize != particle;
                if !is_there || turns.iter().any(|turns| turns.abs_diff(0) > FARTHEST) {
                    return Err("a list names nobody");
                }
                list.push(Found {
                    particle: *other,
                    turns: (*turns).into(),
                });
            }
            ties.push(Tie {
                leash: tie.leash,
                lonely: tie.lonely,
                list,
                bed: None,
                divided: false,
            });
        }
        let mut cells = Cells::restore(boundary, &saved.cells, count)?;
        for (particle, tie) in (0..).zip(&saved.ties) {
            let reach = radius_of(saved.largest, particle) + tie.leash;
            cells.seat_at(particle, &tie.anchor, reach);
        }
        let neighbours = Neighbours {
            cells,
            ties,
            largest: saved.largest,
            longest: saved.longest,
            periods: std::array::from_fn(|axis| {
                boundary.period(axis).map_or(0.0, |period| period.length)
            }),
        };
        if !neighbours.are_mutual() {
            return Err("two lists do not agree");
        }
        Ok(neighbours)
    }

    /// Whether grains that move are on the lists of those on their own, and
    /// nobody at rest has a list.
    fn are_mutual(&self) -> bool {
        self.ties.iter().enumerate().all(|(particle, tie)| {
            if tie.leash == 0.0 {
                return tie.list.is_empty();
            }
            tie.list.iter().all(|found| {
                let theirs = &self.ties[found.particle as usize];
                theirs.leash == 0.0 || theirs.list.contains(&found.seen_from(particle as u32))
            })
        })
    }
}
