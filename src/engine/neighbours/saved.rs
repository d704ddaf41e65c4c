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
    /// Of those that have a list.
    ties: Vec<(u32, SavedTie<D>)>,
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
        let of = |(particle, tie): (u32, &Tie<D>)| {
            let named = |link: &Link<D>| (link.particle(), link.image());
            let saved = SavedTie {
                home: tie.home,
                leash: tie.leash,
                lonely: tie.lonely,
                list: tie.list.iter().map(named).collect(),
            };
            (particle, saved)
        };
        SavedNeighbours {
            cells: self.cells.save(),
            ties: self.ties.each().map(of).collect(),
            largest: self.largest,
            longest: self.longest,
        }
    }

    /// The lists of `count` grains that were saved. `stored` says where they are stored, and
    /// their radii on a grid for this largest diameter, in d.
    ///
    /// # Errors
    ///
    /// Says what does not fit.
    pub(in crate::engine) fn restore<B: Boundary<D>>(
        boundary: &B,
        saved: &SavedNeighbours<D>,
        count: usize,
        stored: impl Fn(f64, u32) -> (Vector<D>, f64),
    ) -> Result<Self, &'static str> {
        let positive = |length: f64| length > 0.0 && length.is_finite();
        if !positive(saved.largest) || !positive(saved.longest) {
            return Err("the lists are not those of these grains");
        }
        let mut ties = Sparse::new(count, Tie::loose());
        for (particle, tie) in &saved.ties {
            let particle = *particle;
            if particle as usize >= count || ties.has(particle) {
                return Err("a list belongs to nobody, or to somebody who has one");
            }
            if !(positive(tie.leash) && tie.leash <= saved.longest)
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
            let (_, radius) = stored(saved.largest, particle);
            *ties.make(particle) = Tie {
                home: tie.home,
                reach: radius + tie.leash,
                leash: tie.leash,
                lonely: tie.lonely,
                list,
                ..Tie::loose()
            };
        }
        let cells = Cells::restore(boundary, &saved.cells, count, |cells, particle| {
            if ties.has(particle) {
                (ties[particle].home, ties[particle].reach)
            } else {
                let (stored, radius) = stored(saved.largest, particle);
                (stored - cells.home_shift(particle), radius)
            }
        })?;
        let neighbours = Neighbours {
            cells,
            ties,
            largest: saved.largest,
            longest: saved.longest,
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
