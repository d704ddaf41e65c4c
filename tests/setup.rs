//! The generators of initial states: what they promise, checked by brute force.

use grainfall::analysis::{ball_volume, highest_surface, lowest_surface, slab_fraction};
use grainfall::scenario::{Preset, Start, read_text};
use grainfall::setup::{Base, Crystal, Gas, OneByOne, Rain, Sizes, seeded};
use grainfall::{Mode, Particle, SetupError, Vector};
use xxhash_rust::xxh3::xxh3_64;

const BIMODAL: Sizes = Sizes::Bimodal {
    small: 1.0,
    large: 1.4,
    large_fraction: 0.5,
};

/// The smallest gap of any two grains, and of any grain and itself, over all
/// images one period around; those more than 5 d above each other are skipped.
fn least_gap<const D: usize>(
    grains: &[Particle<D>],
    lengths: &Vector<D>,
    periodic: [bool; D],
) -> f64 {
    let mut least = f64::INFINITY;
    for (i, a) in grains.iter().enumerate() {
        for (j, b) in grains.iter().enumerate().take(i + 1) {
            if !periodic[D - 1] && (a.position - b.position)[D - 1].abs() > 5.0 {
                continue;
            }
            for code in 0..3usize.pow(D as u32) {
                let mut code = code;
                let mut difference = a.position - b.position;
                let mut allowed = true;
                let mut same = i == j;
                for axis in 0..D {
                    let turns = (code % 3) as f64 - 1.0;
                    code /= 3;
                    allowed &= periodic[axis] || turns == 0.0;
                    same &= turns == 0.0;
                    difference[axis] += turns * lengths[axis];
                }
                if allowed && !same {
                    least = least.min(difference.norm() - a.radius() - b.radius());
                }
            }
        }
    }
    least
}

fn volume<const D: usize>(grains: &[Particle<D>]) -> f64 {
    grains.iter().map(|g| ball_volume::<D>(g.radius())).sum()
}

fn hash<const D: usize>(grains: &[Particle<D>]) -> u64 {
    let mut bytes = Vec::new();
    for grain in grains {
        for value in grain.position.iter().chain(grain.velocity.iter()) {
            bytes.extend(value.to_bits().to_le_bytes());
        }
        bytes.extend(grain.diameter.to_bits().to_le_bytes());
    }
    xxh3_64(&bytes)
}

fn lateral<const D: usize>(periodic: bool) -> [bool; D] {
    let mut axes = [periodic; D];
    axes[D - 1] = false;
    axes
}

// ---------------------------------------------------------------- the rain

#[test]
fn the_papers_rain() {
    let rain = Rain::<3>::default();
    let grains = rain.grains(&mut seeded(1)).unwrap();
    assert_eq!(grains.len(), 4800);
    assert_eq!(lowest_surface(&grains), Some(0.0));
    // 4800 π/6 / (0.0503 · 100) = 499.66.
    let top = highest_surface(&grains).unwrap();
    assert!(top > 497.0 && top < 499.67, "{top}");
    for grain in &grains {
        assert_eq!(grain.velocity, Vector::<3>::new(0.0, 0.0, -2.5));
        assert_eq!(
            (grain.diameter, grain.mass, grain.mode),
            (1.0, 1.0, Mode::Falling)
        );
        for axis in 0..2 {
            assert!((0.0..10.0).contains(&grain.position[axis]));
        }
    }
    assert!(least_gap(&grains, &rain.lengths, lateral(true)) > 0.0);
    // As dense below as above: χ² over 20 slabs has 19 degrees of freedom, and
    // 50 is exceeded once in 7000 times.
    for axis in 0..3 {
        let length = if axis == 2 { top } else { 10.0 };
        let mut slabs = [0.0; 20];
        for grain in &grains {
            slabs[((20.0 * grain.position[axis] / length) as usize).min(19)] += 1.0;
        }
        let chi: f64 = slabs
            .iter()
            .map(|n| (n - 240.0) * (n - 240.0) / 240.0)
            .sum();
        assert!(chi < 50.0, "axis {axis}: {chi}");
    }
}

#[test]
fn a_rain_has_its_density_whatever_the_sizes() {
    fn check<const D: usize>(sizes: Sizes, fraction: f64, periodic: bool) {
        let mut origin = Vector::<D>::repeat(-2.0);
        origin[D - 1] = 3.3;
        let rain = Rain::<D> {
            count: 600,
            sizes,
            packing_fraction: fraction,
            lengths: Vector::repeat(6.0),
            origin,
            periodic: [periodic; D],
            ..Rain::default()
        };
        let grains = rain.grains(&mut seeded(5)).unwrap();
        assert_eq!(grains.len(), 600);
        let bottom = lowest_surface(&grains).unwrap();
        assert!((bottom - 3.3).abs() < 1e-15);
        assert!(least_gap(&grains, &rain.lengths, lateral(periodic)) > 0.0);
        let area = 6.0_f64.powi(D as i32 - 1);
        let height = highest_surface(&grains).unwrap() - bottom;
        let found = volume(&grains) / (area * height);
        // A hair denser than asked for, since the column is cut to its grains.
        assert!(found >= fraction && found < 1.05 * fraction, "{found}");
        for grain in &grains {
            let mass = grain.diameter.powi(D as i32);
            assert!((grain.mass / mass - 1.0).abs() < 1e-15);
            for axis in 0..D - 1 {
                let inset = if periodic { 0.0 } else { grain.radius() };
                assert!(grain.position[axis] >= -2.0 + inset);
                assert!(grain.position[axis] <= 4.0 - inset);
            }
        }
    }
    for periodic in [true, false] {
        check::<3>(Sizes::default(), 0.2, periodic);
        check::<3>(BIMODAL, 0.15, periodic);
        check::<3>(
            Sizes::LogNormal {
                median: 0.8,
                spread: 0.2,
            },
            0.1,
            periodic,
        );
        check::<2>(BIMODAL, 0.35, periodic);
        check::<2>(
            Sizes::Uniform {
                least: 0.3,
                most: 2.0,
            },
            0.1,
            periodic,
        );
    }
}

#[test]
fn impossible_rains_are_refused() {
    let refuse = |change: fn(&mut Rain<3>)| {
        let mut rain = Rain::<3> {
            count: 500,
            ..Rain::default()
        };
        change(&mut rain);
        rain.grains(&mut seeded(1)).unwrap_err()
    };
    let narrow = refuse(|rain| rain.lengths[0] = 1.9);
    assert!(
        matches!(narrow, SetupError::PeriodTooShort { axis: 0, .. }),
        "{narrow}"
    );
    let polydisperse = refuse(|rain| {
        rain.sizes = BIMODAL;
        rain.lengths[1] = 2.7;
    });
    assert!(matches!(
        polydisperse,
        SetupError::PeriodTooShort { axis: 1, .. }
    ));
    let walls = refuse(|rain| {
        rain.periodic[0] = false;
        rain.lengths[0] = 0.9;
    });
    assert!(matches!(
        walls,
        SetupError::Parameter {
            field: "length",
            ..
        }
    ));
    let dense = refuse(|rain| rain.packing_fraction = 0.5);
    assert!(
        matches!(dense, SetupError::NoRoom { wanted: 500, .. }),
        "{dense}"
    );
    let slow = refuse(|rain| rain.fall_speed = 0.0);
    assert!(matches!(
        slow,
        SetupError::Parameter {
            field: "fall_speed",
            ..
        }
    ));
    let nowhere = refuse(|rain| rain.origin[2] = f64::NAN);
    assert!(matches!(
        nowhere,
        SetupError::Parameter {
            field: "origin",
            ..
        }
    ));
}

// ---------------------------------------------------------------- the gas

#[test]
fn a_gas_is_what_was_asked_for() {
    fn check<const D: usize>(count: usize, sizes: Sizes, fraction: f64, aspect: Vector<D>) {
        let gas = Gas::<D> {
            count,
            sizes,
            packing_fraction: fraction,
            temperature: 0.37,
            aspect,
        };
        let (grains, lengths) = gas.grains(&mut seeded(11)).unwrap();
        assert_eq!(grains.len(), count);
        assert!((volume(&grains) / lengths.product() / fraction - 1.0).abs() < 1e-13);
        assert!((lengths[0] / lengths[D - 1] * aspect[D - 1] / aspect[0] - 1.0).abs() < 1e-14);
        let gap = least_gap(&grains, &lengths, [true; D]);
        assert!(gap > 0.0, "{gap:e}");
        let mut momentum = Vector::<D>::zeros();
        let mut twice_energy = 0.0;
        for grain in &grains {
            assert_eq!(grain.mode, Mode::Normal);
            for axis in 0..D {
                assert!((0.0..lengths[axis]).contains(&grain.position[axis]));
            }
            momentum += grain.velocity * grain.mass;
            twice_energy += 2.0 * grain.kinetic_energy();
        }
        assert!(momentum.norm() < 1e-11, "{momentum}");
        assert!((twice_energy / (D * count) as f64 - 0.37).abs() < 1e-14);
    }
    check::<3>(500, Sizes::default(), 0.05, Vector::<3>::repeat(1.0));
    check::<3>(500, Sizes::default(), 0.5, Vector::<3>::new(1.0, 2.0, 0.7));
    check::<3>(400, BIMODAL, 0.58, Vector::<3>::repeat(1.0));
    check::<3>(
        400,
        Sizes::LogNormal {
            median: 10.0,
            spread: 0.15,
        },
        0.4,
        Vector::<3>::repeat(3.0),
    );
    check::<2>(300, Sizes::default(), 0.7, Vector::<2>::repeat(1.0));
    check::<2>(300, BIMODAL, 0.75, Vector::<2>::new(1.0, 1.5));
    check::<1>(50, BIMODAL, 0.8, Vector::<1>::repeat(1.0));
    check::<4>(600, Sizes::default(), 0.2, Vector::<4>::repeat(1.0));
}

/// Steinhardt's global bond order Q₆ (doi:10.1103/PhysRevB.28.784) of the bonds
/// shorter than `cut_off`. By the addition theorem its square is the mean of
/// P₆ of the angle between any two bonds.
fn bond_order(places: &[Vector<3>], lengths: &Vector<3>, cut_off: f64) -> f64 {
    let mut bonds = Vec::new();
    for i in 0..places.len() {
        for j in 0..i {
            let mut bond = places[i] - places[j];
            for axis in 0..3 {
                bond[axis] -= lengths[axis] * (bond[axis] / lengths[axis]).round();
            }
            if bond.norm() < cut_off {
                bonds.push(bond.normalize());
            }
        }
    }
    let mut sum = 0.0;
    for a in &bonds {
        for b in &bonds {
            let x = a.dot(b) * a.dot(b);
            sum += (231.0 * x * x * x - 315.0 * x * x + 105.0 * x - 5.0) / 16.0;
        }
    }
    (sum / (bonds.len() * bonds.len()) as f64).sqrt()
}

#[test]
fn a_dense_gas_is_no_crystal() {
    let gas = Gas::<3> {
        count: 500,
        packing_fraction: 0.5,
        ..Gas::default()
    };
    let (grains, lengths) = gas.grains(&mut seeded(3)).unwrap();
    let places: Vec<_> = grains.iter().map(|grain| grain.position).collect();
    let edge = lengths[0] / 5.0;
    let mut crystal = Vec::new();
    for code in 0..125 {
        let corner = [code % 5, code / 5 % 5, code / 25].map(f64::from);
        for offset in [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.0],
            [0.5, 0.0, 0.5],
            [0.0, 0.5, 0.5],
        ] {
            crystal.push((Vector::<3>::from(corner) + Vector::<3>::from(offset)) * edge);
        }
    }
    let ordered = bond_order(&crystal, &lengths, 1.35);
    assert!((ordered - 0.574_52).abs() < 1e-5, "{ordered}");
    // Independent bonds would give about 1/√2000 = 0.02.
    let found = bond_order(&places, &lengths, 1.35);
    assert!(found < 0.06, "{found}");
}

#[test]
fn impossible_gases_are_refused() {
    let refuse = |change: fn(&mut Gas<3>)| {
        let mut gas = Gas::<3> {
            count: 200,
            ..Gas::default()
        };
        change(&mut gas);
        gas.grains(&mut seeded(1)).unwrap_err()
    };
    let jammed = refuse(|gas| gas.packing_fraction = 0.72);
    let SetupError::Parameter { field, allowed, .. } = jammed else {
        panic!("{jammed}");
    };
    assert!(field == "packing_fraction" && allowed.contains("jam"));
    let tiny = refuse(|gas| gas.count = 3);
    assert!(matches!(tiny, SetupError::PeriodTooShort { .. }), "{tiny}");
    let alone = refuse(|gas| gas.count = 1);
    assert!(matches!(
        alone,
        SetupError::Parameter { field: "count", .. }
    ));
    let cold = refuse(|gas| gas.temperature = -1.0);
    assert!(matches!(
        cold,
        SetupError::Parameter {
            field: "temperature",
            ..
        }
    ));
    let flat = refuse(|gas| gas.aspect[1] = 0.0);
    assert!(matches!(
        flat,
        SetupError::Parameter {
            field: "aspect",
            ..
        }
    ));
    let sizes = refuse(|gas| gas.sizes = Sizes::Equal { diameter: -1.0 });
    assert!(matches!(
        sizes,
        SetupError::Parameter {
            field: "diameter",
            ..
        }
    ));
}

// ---------------------------------------------------------------- the base

/// Drops grains of this diameter at random places; all have to be stopped.
fn assert_no_holes<const D: usize>(base: &Base<D>, grains: &[Particle<D>], diameter: f64) {
    use rand_chacha::rand_core::Rng;
    let mut rng = seeded(99);
    for _ in 0..20_000 {
        let mut place = Vector::<D>::zeros();
        for axis in 0..D - 1 {
            let inset = if base.periodic[axis] {
                0.0
            } else {
                0.5 * diameter
            };
            let share = f64::from(rng.next_u32()) / 4_294_967_296.0;
            place[axis] = base.origin[axis] + inset + (base.lengths[axis] - 2.0 * inset) * share;
        }
        let stopped = grains.iter().any(|grain| {
            let mut square = 0.0;
            for axis in 0..D - 1 {
                let mut offset = grain.position[axis] - place[axis];
                if base.periodic[axis] {
                    offset -= base.lengths[axis] * (offset / base.lengths[axis]).round();
                }
                square += offset * offset;
            }
            let contact = 0.5 * (grain.diameter + diameter);
            square < contact * contact
        });
        assert!(stopped, "a grain falls through at {place}");
    }
}

#[test]
fn the_papers_base() {
    // Made in about 0.1 s in a release build.
    for seed in 0..5 {
        let mut base = Base::<3>::default();
        base.origin[2] = -7.0;
        let grains = base.grains(&mut seeded(seed)).unwrap();
        assert!(
            grains
                .iter()
                .all(|g| g.mode == Mode::Fixed && g.velocity.norm() == 0.0)
        );
        assert_eq!(lowest_surface(&grains), Some(-7.0));
        let top = highest_surface(&grains).unwrap() + 7.0;
        assert!(top > 2.7 && top < 3.0, "{top}");
        // φ = 0.60 is 229 centres in 200 d³; the cut changes that by a few.
        assert!((200..260).contains(&grains.len()), "{}", grains.len());
        assert!(least_gap(&grains, &base.lengths, lateral(true)) > 0.0);
        assert_no_holes(&base, &grains, 1.0);
        // Inside the slab, where no cut is near, it is as dense as a heap.
        let inside = slab_fraction(&grains, 100.0, -6.2, -4.8);
        assert!(inside > 0.5 && inside < 0.65, "{inside}");
    }
}

#[test]
fn bases_of_other_kinds() {
    fn check<const D: usize>(sizes: Sizes, lengths: Vector<D>, periodic: bool) {
        let base = Base::<D> {
            sizes,
            lengths,
            origin: Vector::repeat(1.5),
            periodic: [periodic; D],
        };
        let grains = base.grains(&mut seeded(4)).unwrap();
        assert!((lowest_surface(&grains).unwrap() - 1.5).abs() < 1e-15);
        let centres = |fold: fn(f64, f64) -> f64| {
            grains
                .iter()
                .map(|g| g.position[D - 1])
                .reduce(fold)
                .unwrap()
        };
        assert!(centres(f64::max) - centres(f64::min) <= lengths[D - 1]);
        assert!(least_gap(&grains, &lengths, lateral(periodic)) > 0.0);
        assert_no_holes(&base, &grains, sizes.smallest());
        if !periodic {
            for grain in &grains {
                for axis in 0..D - 1 {
                    assert!(grain.position[axis] - grain.radius() >= 1.5);
                    assert!(grain.position[axis] + grain.radius() <= 1.5 + lengths[axis]);
                }
            }
        }
    }
    check::<3>(BIMODAL, Vector::<3>::new(8.0, 5.0, 2.5), true);
    check::<3>(Sizes::default(), Vector::<3>::new(6.0, 3.0, 2.0), false);
    check::<2>(Sizes::default(), Vector::<2>::new(30.0, 2.0), true);
    check::<2>(BIMODAL, Vector::<2>::new(20.0, 2.5), false);
    check::<2>(Sizes::default(), Vector::<2>::new(1.2, 2.0), false);
    check::<3>(Sizes::default(), Vector::<3>::new(1.3, 1.3, 2.0), false);
    check::<1>(Sizes::default(), Vector::<1>::new(2.0), true);
}

#[test]
fn impossible_bases_are_refused() {
    let thin = Base::<3> {
        lengths: Vector::<3>::new(5.0, 5.0, 0.0),
        ..Base::default()
    };
    let error = thin.grains(&mut seeded(1)).unwrap_err();
    assert!(matches!(
        error,
        SetupError::Parameter {
            field: "thickness",
            ..
        }
    ));
    let narrow = Base::<3> {
        lengths: Vector::<3>::new(5.0, 1.5, 2.0),
        ..Base::default()
    };
    let error = narrow.grains(&mut seeded(1)).unwrap_err();
    assert!(matches!(error, SetupError::PeriodTooShort { axis: 1, .. }));
    // Grains that fill the width between two walls can't be grown there.
    let column = Base::<2> {
        lengths: Vector::<2>::new(1.0, 2.0),
        periodic: [false; 2],
        ..Base::default()
    };
    let error = column.grains(&mut seeded(1)).unwrap_err();
    assert!(matches!(error, SetupError::NoRoom { .. }), "{error}");
}

#[test]
fn a_rain_on_a_base_touches_it_and_no_more() {
    let mut rng = seeded(8);
    let base = Base::<3>::default().grains(&mut rng).unwrap();
    let mut rain = Rain::<3> {
        count: 300,
        ..Rain::default()
    };
    rain.origin[2] = highest_surface(&base).unwrap();
    let mut grains = base;
    grains.extend(rain.grains(&mut rng).unwrap());
    assert!(least_gap(&grains, &rain.lengths, lateral(true)) > 0.0);
}

// ---------------------------------------------------------------- one by one

#[test]
fn one_by_one_starts_above_the_top() {
    let source = OneByOne::<3> {
        sizes: BIMODAL,
        periodic: [true, false, false],
        origin: Vector::<3>::new(-5.0, 2.0, 0.0),
        ..OneByOne::default()
    };
    let mut rng = seeded(1);
    let mut sums = Vector::<3>::zeros();
    for _ in 0..2000 {
        let grain = source.grain(12.0, &mut rng).unwrap();
        assert_eq!(grain.mode, Mode::Falling);
        assert_eq!(grain.velocity, Vector::<3>::new(0.0, 0.0, -2.5));
        assert!((grain.position[2] - grain.radius() - 14.0).abs() < 1e-14);
        assert!((-5.0..5.0).contains(&grain.position[0]));
        assert!(grain.position[1] >= 2.0 + grain.radius());
        assert!(grain.position[1] <= 12.0 - grain.radius());
        sums += grain.position / 2000.0;
    }
    // Uniform: the mean is off by five of 10/√12/√2000 at most.
    assert!(
        sums[0].abs() < 0.33 && (sums[1] - 7.0).abs() < 0.33,
        "{sums}"
    );
    assert!(source.grain(f64::NAN, &mut rng).is_err());
}

// ---------------------------------------------------------------- the crystal

#[test]
fn a_crystal_has_its_density_and_twelve_neighbours_each() {
    for (cells, packing_fraction) in [(3, 0.1), (4, 0.3), (3, 0.5), (2, 0.7)] {
        let crystal = Crystal {
            cells,
            packing_fraction,
            temperature: 2.0,
        };
        let (grains, edges) = crystal.grains(&mut seeded(3)).unwrap();
        assert_eq!(grains.len(), 4 * cells * cells * cells);
        let found = volume(&grains) / edges.product();
        assert!((found / packing_fraction - 1.0).abs() < 1e-14, "{found}");
        // Four grains a cell, each a face's half diagonal from the next.
        let nearest = edges[0] / cells as f64 / 2.0_f64.sqrt();
        for a in &grains {
            assert!(a.mode == Mode::Normal && a.diameter == 1.0 && a.mass == 1.0);
            let mut neighbours = 0;
            for b in &grains {
                let mut distance = b.position - a.position;
                for axis in 0..3 {
                    distance[axis] -= edges[axis] * (distance[axis] / edges[axis]).round();
                }
                let distance = distance.norm();
                let next = (distance / nearest - 1.0).abs() < 1e-12;
                // The next shell is √2 as far away. A box of two cells shows each
                // of its grains once, but those in the first shell all.
                assert!(
                    next || distance == 0.0 || distance > 1.41 * nearest,
                    "{distance}"
                );
                neighbours += u32::from(next);
            }
            assert_eq!(neighbours, 12, "φ = {packing_fraction}");
            assert!(a.position.iter().all(|x| *x > 0.0 && *x < edges[0]));
        }
        let momentum: Vector<3> = grains.iter().map(|grain| grain.velocity).sum();
        assert!(momentum.norm() < 1e-12);
        let energy: f64 = grains.iter().map(Particle::kinetic_energy).sum();
        let per_grain = energy / grains.len() as f64;
        assert!((per_grain - 3.0).abs() < 1e-12, "{per_grain}");
    }
}

#[test]
fn crystals_that_cannot_be_are_refused() {
    let crystal = |cells, packing_fraction, temperature| {
        Crystal {
            cells,
            packing_fraction,
            temperature,
        }
        .grains(&mut seeded(1))
    };
    // Where the grains touch, π/√18.
    assert!(crystal(3, 0.74, 1.0).is_ok());
    for refused in [
        crystal(0, 0.3, 1.0),
        crystal(1001, 0.3, 1.0),
        crystal(3, 0.741, 1.0),
        crystal(3, 0.0, 1.0),
        crystal(3, f64::NAN, 1.0),
        crystal(3, 0.3, -1.0),
        crystal(3, 0.3, f64::INFINITY),
    ] {
        assert!(matches!(refused, Err(SetupError::Parameter { .. })));
    }
    let narrow = crystal(1, 0.3, 1.0);
    assert!(matches!(narrow, Err(SetupError::PeriodTooShort { .. })));
}

#[test]
fn numbers_of_grains_that_fill_cells() {
    for (count, cells) in [(4, 1), (32, 2), (1372, 7), (1_000_188, 63)] {
        assert_eq!(Crystal::cells_of(count), Some(cells));
        assert_eq!(Crystal::counts_around(count), (count, count));
    }
    assert_eq!(Crystal::counts_around(1000), (864, 1372));
    for count in [0, 1, 5, 1000, usize::MAX] {
        assert_eq!(Crystal::cells_of(count), None, "{count}");
    }
}

// ---------------------------------------------------------------- the seed

#[test]
fn a_seed_means_the_same_bits_everywhere() {
    let rain = |seed| {
        let rain = Rain::<3> {
            count: 1000,
            sizes: Sizes::LogNormal {
                median: 1.0,
                spread: 0.1,
            },
            ..Rain::default()
        };
        hash(&rain.grains(&mut seeded(seed)).unwrap())
    };
    let gas = |seed| {
        let gas = Gas::<2> {
            count: 200,
            packing_fraction: 0.6,
            ..Gas::default()
        };
        hash(&gas.grains(&mut seeded(seed)).unwrap().0)
    };
    let base = |seed| hash(&Base::<3>::default().grains(&mut seeded(seed)).unwrap());
    assert_eq!([rain(1), gas(1), base(1)], [rain(1), gas(1), base(1)]);
    assert!(rain(1) != rain(2) && gas(1) != gas(2) && base(1) != base(2));
    // Changes only when a generator, or the engine that grows packings, is
    // changed on purpose.
    let found = [rain(1), gas(1), base(1)].map(|hash| format!("{hash:016x}"));
    assert_eq!(
        found,
        ["c7b7a10627cd08fd", "4b3d123cf7815493", "b2fc430d04f96e51"]
    );
}

/// The grains with which a preset starts.
fn start_of(preset: &str, assignments: &[&str]) -> Vec<Particle<3>> {
    let mut origin = Preset::named(preset).unwrap().origin();
    origin.assignments = assignments.iter().map(|set| set.parse().unwrap()).collect();
    let scenario = read_text(&origin).unwrap();
    Start::<3>::new(&origin, &scenario).unwrap().grains
}

#[test]
fn numbering_changes_the_order_within_each_source_alone() {
    let few = "grains.1.rain.count=200";
    let drawn = start_of("deposition", &[few]);
    let space = start_of("deposition", &[few, "numbering=\"space\""]);
    assert_ne!(drawn, space);
    let fixed = drawn.len() - 200;
    for part in [0..fixed, fixed..drawn.len()] {
        let sorted = |grains: &[Particle<3>]| {
            let mut grains = grains[part.clone()].to_vec();
            grains.sort_by_key(|grain| grain.position.map(f64::to_bits).data.0);
            grains
        };
        assert_eq!(sorted(&drawn), sorted(&space));
    }
}
