//! The queue against a sorted map.

use super::*;
use proptest::prelude::*;

fn key(units: f64, particle: u32) -> Key {
    Key {
        time: Time::from_units(units),
        rank: Rank::Contact,
        low: particle,
        high: particle,
    }
}

proptest! {
    /// Against a sorted map: random re-scheduling over twelve decades of
    /// waiting times.
    #[test]
    fn serves_in_order(
        waits in proptest::collection::vec((0u32..40, -10.0..2.0f64, 0u8..8), 1..600)
    ) {
        let mut queue = EventQueue::new(40, Time::ZERO);
        for _ in 0..40 {
            queue.push_empty();
        }
        let mut sorted = std::collections::BTreeMap::new();
        let mut keys = [key(f64::INFINITY, 0); 40];
        let mut clock = 0.0;
        for (particle, exponent, action) in waits {
            if action == 0 {
                let expected = sorted.iter().next().map(|(key, particle)| (*particle, *key));
                prop_assert_eq!(queue.peek(|particle| keys[particle as usize]), expected);
                if let Some((first, first_key)) = expected {
                    clock = f64::max(clock, first_key.time.units());
                    queue.set(first, Key { time: Time::NEVER, ..first_key });
                    sorted.remove(&first_key);
                }
                continue;
            }
            let new = key(clock + libm::exp10(exponent), particle);
            sorted.retain(|_, p| *p != particle);
            sorted.insert(new, particle);
            keys[particle as usize] = new;
            queue.set(particle, new);
        }
        while let Some((key, particle)) = sorted.pop_first() {
            prop_assert_eq!(queue.peek(|particle| keys[particle as usize]), Some((particle, key)));
            queue.set(particle, Key { time: Time::NEVER, ..key });
        }
        prop_assert_eq!(queue.peek(|particle| keys[particle as usize]), None);
    }
}

#[test]
fn equal_times_go_by_kind_then_ids() {
    let mut queue = EventQueue::new(4, Time::ZERO);
    for _ in 0..4 {
        queue.push_empty();
    }
    let at = |rank, low, high| Key {
        time: Time::from_units(1.0),
        rank,
        low,
        high,
    };
    let keys = [
        at(Rank::Transfer, 0, 0),
        at(Rank::Sleep, 1, 1),
        at(Rank::Contact, 1, 2),
        at(Rank::Contact, 2, 3),
    ];
    for particle in [0, 3, 2, 1] {
        queue.set(particle, keys[particle as usize]);
    }
    let mut order = Vec::new();
    while let Some((particle, key)) = queue.peek(|particle| keys[particle as usize]) {
        order.push(particle);
        queue.set(
            particle,
            Key {
                time: Time::NEVER,
                ..key
            },
        );
    }
    assert_eq!(order, [2, 3, 1, 0]);
}

/// The clock may stand still while entries far ahead are set anew again and again.
#[test]
fn entries_set_anew_take_no_more_room() {
    let mut queue = EventQueue::new(2, Time::ZERO);
    let near = [key(1.0e-6, 0), key(0.0, 1)];
    for (particle, key) in (0..).zip(near) {
        queue.push_empty();
        queue.set(particle, key);
    }
    for round in 0..200_000 {
        let slot = 1 + round % 1000;
        queue.set(0, key(1.0e-3 * f64::from(slot), 0));
        if round % 3 == 0 {
            queue.set(0, near[0]);
        }
    }
    assert!(queue.lists.leaves() <= 2 * 2 + SPARE + 1);
    let keys = [key(0.25, 0), near[1]];
    queue.set(0, keys[0]);
    let known = |particle: u32| keys[particle as usize];
    assert_eq!(queue.peek(known), Some((1, keys[1])));
    queue.set(1, key(f64::INFINITY, 1));
    assert_eq!(queue.check_numbers(), Ok(()));
    assert_eq!(queue.peek(known), Some((0, keys[0])));
    queue.set(0, key(f64::INFINITY, 0));
    assert_eq!(queue.peek(known), None);
}

#[test]
fn an_entry_out_of_order_is_seen() {
    let mut queue = EventQueue::new(2, Time::ZERO);
    let keys = [key(0.0, 0), key(1.0e-9, 1)];
    for (particle, key) in (0..).zip(keys) {
        queue.push_empty();
        queue.set(particle, key);
    }
    assert_eq!(queue.heap.len(), 2);
    assert_eq!(queue.check_entry(1, keys[1]), Ok(()));
    queue.heap[0].key = key(2.0e-9, 0);
    let fault = queue.check_entry(1, keys[1]).unwrap_err();
    assert!(fault.contains("comes before 0"), "{fault}");
}

#[test]
fn entries_filed_elsewhere_are_seen() {
    let mut sound = EventQueue::new(2, Time::ZERO);
    let later = key(0.5, 1);
    for (particle, key) in (0..).zip([key(0.0, 0), later]) {
        sound.push_empty();
        sound.set(particle, key);
    }
    assert_eq!(sound.check_numbers(), Ok(()));
    assert_eq!(sound.check_entry(1, later), Ok(()));
    let see = |check: Result<(), String>, name: &str| {
        let fault = check.unwrap_err();
        assert!(fault.contains(name), "{fault}");
    };

    let mut miscounted = sound.clone();
    miscounted.filed[0] += 1;
    see(miscounted.check_numbers(), "entries are filed, not");

    let mut misplaced = sound.clone();
    misplaced.places[1] = BEYOND;
    see(misplaced.check_entry(1, later), "is filed in");

    let mut lost = sound;
    lost.lists = Lists::new(lost.lists.len());
    see(lost.check_entry(1, later), "is not on list");
}
