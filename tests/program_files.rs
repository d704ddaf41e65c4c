//! Files come back as they were: frames, scenarios, pictures.
#![cfg(feature = "program")]

use std::io::BufReader;

use grainfall::boundary::{Cuboid, Side};
use grainfall::output::{Frame, XyzReader};
use grainfall::scenario::{
    Assignment, Format, Gravity, Origin, Preset, Threshold, json_schema, presets, read_text,
};
use grainfall::{Mode, Particle, Time, Vector};
use proptest::prelude::*;

const MODES: [Mode; 4] = [Mode::Normal, Mode::Falling, Mode::Frozen, Mode::Fixed];

fn text_of(frame: &Frame) -> Vec<u8> {
    let mut text = Vec::new();
    frame.write(&mut text).unwrap();
    text
}

fn read_frames(text: &[u8]) -> Vec<Frame> {
    XyzReader::new(BufReader::new(text))
        .collect::<Result<_, _>>()
        .unwrap()
}

/// Any number that is finite, down to the smallest ones.
fn finite() -> impl Strategy<Value = f64> {
    any::<u64>()
        .prop_map(f64::from_bits)
        .prop_filter("finite", |x| x.is_finite())
}

fn grain<const D: usize>() -> impl Strategy<Value = Particle<D>> {
    (
        prop::collection::vec(finite(), 2 * D),
        1.0e-300..1.0e300f64,
        1.0e-300..1.0e300f64,
        0..4usize,
    )
        .prop_map(|(numbers, diameter, mass, mode)| Particle {
            position: Vector::from_fn(|axis, _| numbers[axis]),
            velocity: Vector::from_fn(|axis, _| numbers[D + axis]),
            diameter,
            mass,
            mode: MODES[mode],
        })
}

fn bits<const D: usize>(grain: &Particle<D>) -> Vec<u64> {
    let numbers = grain.position.iter().chain(grain.velocity.iter());
    numbers
        .chain([&grain.diameter, &grain.mass])
        .map(|number| number.to_bits())
        .collect()
}

proptest! {
    #[test]
    fn frames_in_space_come_back_bit_by_bit(
        grains in prop::collection::vec(grain::<3>(), 0..20),
        units in 0.0..1.0e6f64,
        tiny in 0.0..1.0e-9f64,
    ) {
        let time = Time::from_units(units) + tiny;
        let sides = [Side::periodic(7.3), Side::periodic(0.1), Side::floor(-1.0, 0.4)];
        let frame = Frame::new(&grains, time, &Cuboid::new(sides).unwrap());
        let found = read_frames(&text_of(&frame));
        prop_assert_eq!(found.len(), 1);
        prop_assert_eq!(found[0].time, time);
        prop_assert_eq!(found[0].periodic, [true, true, false]);
        let back = found[0].particles::<3>();
        prop_assert_eq!(back.len(), grains.len());
        for (back, grain) in back.iter().zip(&grains) {
            prop_assert_eq!(bits(back), bits(grain));
            prop_assert_eq!(back.mode, grain.mode);
        }
    }

    #[test]
    fn frames_in_the_plane_come_back_bit_by_bit(
        grains in prop::collection::vec(grain::<2>(), 1..20),
    ) {
        let frame = Frame::new(&grains, Time::ZERO, &Cuboid::open());
        let found = read_frames(&text_of(&frame));
        prop_assert_eq!(found[0].dimension, 2);
        for (back, grain) in found[0].particles::<2>().iter().zip(&grains) {
            prop_assert_eq!(bits(back), bits(grain));
        }
    }
}

#[test]
fn the_box_of_grains_at_the_ends_of_the_world_is_finite() {
    let at = |x: f64| Particle::<2>::fixed(Vector::<2>::new(x, 0.0));
    let grains = [at(f64::MIN), at(f64::MAX)];
    let frame = Frame::new(&grains, Time::ZERO, &Cuboid::open());
    let back = &read_frames(&text_of(&frame))[0];
    assert_eq!(back.lengths[0], f64::MAX);
    assert_eq!(back.particles::<2>()[1].position[0], f64::MAX);
}

#[test]
fn frames_stand_one_after_the_other() {
    let at = |x: f64| [Particle::<2>::fixed(Vector::<2>::new(x, 0.0))];
    let mut text = Vec::new();
    for step in 0..4 {
        let time = Time::from_units(f64::from(step));
        let frame = Frame::new(&at(f64::from(step)), time, &Cuboid::open());
        text.extend(text_of(&frame));
    }
    let reader = || XyzReader::new(BufReader::new(&text[..]));
    assert_eq!(read_frames(&text).len(), 4);
    assert_eq!(reader().last_frame().unwrap().time.units(), 3.0);
    let near = |time| reader().frame_near(time).unwrap().time.units();
    assert_eq!(
        [near(-5.0), near(1.2), near(1.5), near(9.0)],
        [0.0, 1.0, 1.0, 3.0]
    );
}

#[test]
fn files_of_other_programs_are_read() {
    let text = "2\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=species:S:1:pos:R:3:forces:R:3:\
                diameter:R:1:id:I:1 energy=-3.1 Time=2.5\n\
                Si 1 2 3 9 9 9 1.5 12\nSi 4 5 6 9 9 9 0.5 11\n";
    let frame = &read_frames(text.as_bytes())[0];
    // Sorted by id; masses go with the volume.
    assert_eq!(frame.grains[0].position, Vector::<3>::new(4.0, 5.0, 6.0));
    assert_eq!(frame.grains[1].diameter, 1.5);
    assert_eq!(frame.grains[1].mass, 1.5 * 1.5 * 1.5);
    assert_eq!(frame.lengths, [5.0; 3]);
    assert_eq!(frame.time.units(), 2.5);
    let plain = &read_frames(b"1\nwater\nO 1 2 3\n")[0];
    assert_eq!(plain.grains[0].position, Vector::<3>::new(1.0, 2.0, 3.0));
}

#[test]
fn modes_stand_in_the_column_type_or_mode() {
    for (column, word, mode) in [
        ("type:S:1", "frozen", Mode::Frozen),
        ("mode:S:1", "fixed", Mode::Fixed),
        ("type:I:1", "2", Mode::Normal),
        // Types of somebody else's.
        ("type:S:1", "1", Mode::Normal),
        ("mode:S:1:type:S:1", "frozen sand", Mode::Frozen),
        ("type:S:1:mode:S:1", "fixed falling", Mode::Falling),
        ("mode:S:1:type:S:1", "falling fixed", Mode::Falling),
    ] {
        let text = format!("1\nProperties=pos:R:3:{column}\n1 2 3 {word}\n");
        let frame = &read_frames(text.as_bytes())[0];
        assert_eq!(frame.grains[0].mode, mode, "{column}");
    }
}

#[test]
fn presets_are_the_papers() {
    let deposition = read_text(&Preset::named("deposition").unwrap().origin()).unwrap();
    let parameters = &deposition.parameters;
    assert_eq!(parameters.sleep_speed, 0.1);
    assert_eq!(parameters.wake_speed, Threshold(0.1));
    assert_eq!(parameters.elastic_speed, 1.0e-4);
    assert_eq!(parameters.restitution, 0.7);
    assert_eq!(parameters.frozen_restitution, 0.4);
    assert_eq!(deposition.self_check, None);
    assert_eq!(deposition.gravity, Gravity::Down(1.0));
    assert_eq!(deposition.deposit_area(), Some(100.0));
    let rain = deposition.grains[1].rain.unwrap();
    assert_eq!((rain.count, rain.packing_fraction), (4800, 0.0503));
    let one_by_one = read_text(&Preset::named("one-by-one").unwrap().origin()).unwrap();
    assert_eq!(one_by_one.parameters.wake_speed.0, f64::INFINITY);
    assert_eq!(one_by_one.parameters.sleep_speed, 0.05);
}

/// What a run folder keeps of a scenario says the same as the scenario.
#[test]
fn resolved_scenarios_come_back() {
    let sets = [
        "seed=9",
        "title=\"a = [1]\"",
        "output.frames_every=0.1",
        "self_check.interval=0.1",
    ];
    for preset in presets() {
        let mut origin = preset.origin();
        origin.assignments = sets
            .iter()
            .map(|set| set.parse::<Assignment>().unwrap())
            .collect();
        let scenario = read_text(&origin).unwrap();
        assert_eq!(
            (scenario.seed, scenario.title.as_deref()),
            (9, Some("a = [1]"))
        );
        let text = toml::to_string(&scenario).unwrap();
        assert_eq!(
            read_text(&Origin::toml("again", &text)).unwrap(),
            scenario,
            "{text}"
        );
        // Resolving leaves nothing to be decided.
        assert!(
            text.contains("exit_speed") && text.contains("all_frozen"),
            "{text}"
        );
    }
}

#[test]
fn json_and_toml_say_the_same() {
    for preset in presets() {
        let scenario = read_text(&preset.origin()).unwrap();
        let table: toml::Table = toml::from_str(preset.text).unwrap();
        let json = Origin {
            text: serde_json::to_string(&table).unwrap(),
            format: Format::Json,
            ..Origin::toml("in JSON", "")
        };
        assert_eq!(read_text(&json).unwrap(), scenario, "{}", preset.name);
    }
}

proptest! {
    #[test]
    fn numbers_of_scenarios_come_back(
        x in -1.0e9..1.0e9f64,
        tiny in 1.0e-300..1.0e-3f64,
        seed in 0..=i64::MAX as u64,
    ) {
        let text = format!(
            "dimension = 2\nseed = {seed}\ngravity = [{x:?}, {tiny:?}]\n\
             [[grains]]\nposition = [{x}, {tiny}]\nmass = {tiny:?}\n"
        );
        let scenario = read_text(&Origin::toml("numbers", &text)).unwrap();
        prop_assert_eq!(scenario.grains[0].position.clone(), Some(vec![x, tiny]));
        prop_assert_eq!(&scenario.gravity, &Gravity::Along(vec![x, tiny]));
        let again = toml::to_string(&scenario).unwrap();
        prop_assert_eq!(read_text(&Origin::toml("again", &again)).unwrap(), scenario);
    }
}

/// Every key that a resolved scenario may hold stands in the schema, with a
/// description.
#[test]
fn the_schema_knows_every_key() {
    let schema = json_schema();
    let keys = [
        "title",
        "dimension",
        "seed",
        "gravity",
        "boundaries",
        "parameters",
        "sleep",
    ];
    for key in keys
        .iter()
        .chain(&["self_check", "guards", "stop", "output", "grains"])
    {
        let entry = &schema["properties"][key];
        assert!(entry["description"].is_string(), "{key}: {entry}");
    }
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(
        schema["required"],
        serde_json::json!(["dimension", "grains"])
    );
    let parameters = &schema["$defs"]["Parameters"]["properties"];
    for (key, symbol) in [
        ("restitution", "α"),
        ("frozen_restitution", "α_frozen"),
        ("elastic_speed", "V_c"),
        ("sleep_speed", "V_sleep"),
        ("wake_speed", "V_wakeup"),
    ] {
        let description = parameters[key]["description"].as_str().unwrap();
        assert!(description.contains(symbol), "{key}: {description}");
    }
}

/// 4800 grains in a box, as a deposit has them.
fn deposit() -> Frame {
    let mut grains = Vec::new();
    for layer in 0..48 {
        for place in 0..100 {
            let shift = 0.5 * f64::from(layer % 2);
            let x = f64::from(place % 10) + shift;
            let y = f64::from(place / 10) + shift;
            let mode = MODES[(layer / 12) as usize];
            let velocity = Vector::<3>::new(0.01 * f64::from(place), 0.0, 0.0);
            let position = Vector::<3>::new(x, y, 0.75 * f64::from(layer));
            grains.push(Particle::new(position, velocity).with_mode(mode));
        }
    }
    let sides = [Side::periodic(10.0), Side::periodic(10.0), Side::Open];
    Frame::new(
        &grains,
        Time::from_units(12.5),
        &Cuboid::new(sides).unwrap(),
    )
}

/// Tags open and close in order; says how often each occurs.
fn tags(text: &str) -> std::collections::BTreeMap<&str, usize> {
    let mut counts = std::collections::BTreeMap::new();
    let mut open = Vec::new();
    for part in text.split('<').skip(1) {
        let (tag, rest) = part.split_once('>').expect("a tag ends");
        assert!(
            !rest.contains('&') && tag.matches('"').count() % 2 == 0,
            "{part}"
        );
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        let name = tag.split([' ', '/']).next().unwrap();
        *counts.entry(name).or_insert(0) += 1;
        if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
    counts
}

#[test]
fn pictures_are_well_formed_and_small() {
    let frame = deposit();
    let picture = grainfall::draw::svg(&frame);
    let counts = tags(&picture);
    assert!(picture.starts_with("<svg xmlns=") && counts["svg"] == 1);
    assert!(picture.len() < 1_000_000, "{} bytes", picture.len());
    // A closed packing hides its inside.
    assert!((500..3000).contains(&counts["circle"]), "{counts:?}");
    for mode in MODES {
        assert!(
            picture.contains(&format!("1200 {}", mode.name())),
            "{mode:?}"
        );
    }
    assert!(picture.contains("t = 12.5"));
    assert_eq!(picture, grainfall::draw::svg(&frame));
}

#[test]
fn disks_are_drawn_where_they_lie() {
    let grains: Vec<_> = (0..5)
        .map(|k| Particle::<2>::new(Vector::<2>::new(2.0 * f64::from(k), 0.0), Vector::zeros()))
        .collect();
    let picture = grainfall::draw::svg(&Frame::new(&grains, Time::ZERO, &Cuboid::open()));
    let counts = tags(&picture);
    assert!(!counts.contains_key("radialGradient"));
    let xs: Vec<f64> = picture
        .split("<circle cx=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
        .collect();
    // One after the other, equally far apart to the rounding of the digits.
    for pair in xs[..5].windows(3) {
        assert!((pair[2] - 2.0 * pair[1] + pair[0]).abs() <= 0.21, "{xs:?}");
    }
}

#[test]
fn nothing_at_all_can_be_drawn() {
    for dimension in [2, 3] {
        let mut frame = deposit();
        frame.grains.clear();
        frame.dimension = dimension;
        tags(&grainfall::draw::svg(&frame));
    }
}
