//! Neighbour lists that are saved and made again as they were.

use serde::{Deserialize, Serialize};

use crate::engine::cells::{Cells, Link, SavedCells};
use crate::engine::neighbours::{Changes, Neighbours, Tie};
use crate::engine::sparse::Sparse;
use crate::model::Boundary;
use crate::particle::Vector;

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
    home: Vector<D>,
    leash: f64,
    lonely: bool,
    /// Who is listed, and in which image.
    list: Vec<(u32, u32)>,
}

impl<const D: usize> Neighbours<D> {
    pub(in crate::engine) fn save(&self) -> SavedNeighbours<D> {
        let of = |particle: u32| {
            let tie = &self.ties[particle];
            let named = |link: &Link<D>| (link.particle(), link.image());
            SavedTie {
                home: self.cells.spot(particle).home,
                leash: tie.leash,
                lonely: tie.lonely,
                list: tie.list.iter().map(named).collect(),
            }
        };
        SavedNeighbours {
            cells: self.cells.save(),
            ties: (0..self.ties.len() as u32).map(of).collect(),
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
        let mut ties = Sparse::new(count, Tie::LOOSE);
        for (particle, tie) in (0..).zip(&saved.ties) {
            if !(0.0..=saved.longest).contains(&tie.leash)
                || tie.home.iter().any(|x| !x.is_finite())
            {
                return Err("a leash has a length that none has");
            }
            let mut list = Vec::with_capacity(tie.list.len());
            for &(other, image) in &tie.list {
                let is_there = (other as usize) < count && other != particle;
                if !is_there {
                    return Err("a list names nobody");
                }
                list.push(Link::new(other, image));
            }
            if tie.leash > 0.0 {
                *ties.make(particle) = Tie {
                    leash: tie.leash,
                    lonely: tie.lonely,
                    list,
                    ..Tie::LOOSE
                };
            } else if !list.is_empty() {
                return Err("a grain at rest has a list");
            }
        }
        let mut cells = Cells::restore(boundary, &saved.cells, count)?;
        for (particle, tie) in (0..).zip(&saved.ties) {
            let reach = radius_of(saved.largest, particle) + tie.leash;
            cells.file_at(particle, &tie.home, reach);
        }
        let neighbours = Neighbours {
            cells,
            ties,
            largest: saved.largest,
            longest: saved.longest,
            periods: std::array::from_fn(|axis| {
                boundary.period(axis).map_or(0.0, |period| period.length)
            }),
            fresh: Vec::new(),
            changes: Changes::NONE,
        };
        if !neighbours.are_mutual() {
            return Err("two lists do not agree");
        }
        Ok(neighbours)
    }

    /// Whether grains that move are on the lists of those on their own.
    fn are_mutual(&self) -> bool {
        self.ties.each().all(|(particle, tie)| {
            tie.list.iter().all(|link| {
                let theirs = &self.ties[link.particle()];
                theirs.leash == 0.0 || theirs.list.contains(&link.seen_from(particle))
            })
        })
    }
}
