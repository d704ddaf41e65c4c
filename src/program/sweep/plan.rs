//! Which runs there are.

use std::collections::BTreeMap;
use std::fs;

use toml::{Table, Value};
use xxhash_rust::xxh3::xxh3_64;

use crate::program::cli::SweepArguments;
use crate::program::criteria::Program;
use crate::program::drive::scenario_text;
use crate::program::error::ProgramError;
use crate::program::load::open;
use crate::program::run::{seed_is, until};
use crate::program::sweep::MOST_RUNS;
use crate::program::sweep::crew::Tasks;
use crate::program::sweep::error::SweepError;
use crate::program::sweep::names::{names_of, plain, shortened, unique};
use crate::program::sweep::values::Variation;
use crate::scenario::{Origin, Path, Scenario, read_text};

/// All runs of a sweep, in their order: the first variation changes slowest, the
/// seed fastest.
pub(super) struct Plan {
    /// What the scenario is called.
    pub(super) name: String,
    /// Without the variations.
    origin: Origin,
    pub(super) variations: Vec<Variation>,
    pub(super) seeds: u64,
    first_seed: u64,
    /// For each combination, what folders of its runs begin with.
    names: Vec<String>,
    /// What stands in `sweep.toml`.
    pub(super) text: String,
}

impl Plan {
    /// Refuses every combination that can be refused before grains are made.
    pub(super) fn new(arguments: &SweepArguments, program: &Program) -> Result<Self, ProgramError> {
        let mut variations = arguments.set.clone();
        let end = arguments.until.map(until).map(Variation::fixed);
        variations.extend(end);
        check_paths(&variations)?;
        let combinations = count(&variations, arguments.seeds)?;
        let (name, origin) = open(&arguments.scenario, program)?;
        let mut plan = Plan {
            name,
            origin,
            seeds: arguments.seeds,
            first_seed: arguments.seed.unwrap_or(0),
            names: Vec::new(),
            variations,
            text: String::new(),
        };
        let files = plan.check(combinations, arguments.seed, program)?;
        plan.name_combinations(combinations);
        plan.text = plan.describe(files)?;
        Ok(plan)
    }

    /// Reads every combination once; the seed decides about nothing that can be
    /// known beforehand. Returns the files of grains with their fingerprints.
    fn check(
        &mut self,
        combinations: usize,
        seed: Option<u64>,
        program: &Program,
    ) -> Result<Table, ProgramError> {
        let mut files = Table::new();
        // By fingerprint.
        let mut known: BTreeMap<u64, usize> = BTreeMap::new();
        for combination in 0..combinations {
            let values = self.values_text(combination);
            let one = |source: ProgramError| match values.as_str() {
                "" => source,
                _ => ProgramError::Combination {
                    source: Box::new(source),
                    combination: values.clone(),
                },
            };
            let origin = self.origin_of(combination, seed);
            let scenario = read_text(&origin).map_err(|refusal| one(refusal.into()))?;
            if combination == 0 {
                self.first_seed = scenario.seed;
            }
            let checked = program.runner(&scenario).check(&origin, &scenario);
            checked.map_err(one)?;
            let mut text = scenario_text(&scenario)?;
            for file in scenario
                .grains
                .iter()
                .filter_map(|source| source.file.as_ref())
            {
                if !files.contains_key(file) {
                    let path = origin.folder.join(file);
                    let bytes =
                        fs::read(&path).map_err(ProgramError::io(path.display().to_string()))?;
                    let print = format!("{:016x}", xxh3_64(&bytes));
                    files.insert(file.clone(), Value::String(print));
                }
                // In the text they are called after their place.
                text.extend(file.as_bytes());
            }
            if let Some(earlier) = known.insert(xxh3_64(&text), combination) {
                return Err(SweepError::Duplicate {
                    one: self.values_text(earlier),
                    other: self.values_text(combination),
                }
                .into());
            }
        }
        match self.first_seed.checked_add(self.seeds - 1) {
            Some(last) if i64::try_from(last).is_ok() => Ok(files),
            _ => Err(SweepError::LargeSeed {
                first: self.first_seed,
                seeds: self.seeds,
            }
            .into()),
        }
    }

    fn name_combinations(&mut self, combinations: usize) {
        let names = names_of(&self.variations);
        let name = |combination| {
            let indices = self.indices(combination);
            let words = names.iter().zip(&indices);
            let words: Vec<&str> = words
                .filter_map(|(names, &index)| Some(names.as_ref()?[index].as_str()))
                .collect();
            words.join("_")
        };
        self.names = unique((0..combinations).map(name).collect());
    }

    /// What makes this sweep what it is.
    fn describe(&self, files: Table) -> Result<String, ProgramError> {
        let mut sweep = Table::new();
        let number = |count: u64| Value::Integer(i64::try_from(count).unwrap_or(i64::MAX));
        sweep.insert("version".to_owned(), env!("CARGO_PKG_VERSION").into());
        sweep.insert("first_seed".to_owned(), number(self.first_seed));
        sweep.insert("seeds".to_owned(), number(self.seeds));
        let set = self.variations.iter().map(|variation| {
            let values = variation.values().cloned();
            let mut table = Table::new();
            table.insert("path".to_owned(), variation.title().into());
            table.insert("values".to_owned(), Value::Array(values.collect()));
            Value::Table(table)
        });
        sweep.insert("set".to_owned(), Value::Array(set.collect()));
        if !files.is_empty() {
            sweep.insert("files".to_owned(), Value::Table(files));
        }
        sweep.insert("scenario".to_owned(), Value::Table(self.origin.tree()?));
        let text = toml::to_string(&sweep)
            .map_err(|error| ProgramError::io("sweep.toml")(std::io::Error::other(error)))?;
        Ok(format!(
            "# What this sweep is of: `grainfall sweep` with the same arguments goes on with it.\n\n{text}"
        ))
    }

    /// How many combinations of values there are.
    pub(super) fn combinations(&self) -> usize {
        self.names.len()
    }

    /// How many runs there are.
    pub(super) fn runs(&self) -> usize {
        // At most `MOST_RUNS`.
        self.combinations() * self.seeds as usize
    }

    /// The combination and the seed of a run.
    pub(super) fn combination_of(&self, run: usize) -> (usize, u64) {
        let seeds = self.seeds as usize;
        (run / seeds, self.first_seed + (run % seeds) as u64)
    }

    /// The name of a run's folder.
    pub(super) fn folder_of(&self, run: usize) -> String {
        let (combination, seed) = self.combination_of(run);
        match self.names[combination].as_str() {
            "" => format!("seed={seed}"),
            name => format!("{name}_seed={seed}"),
        }
    }

    /// What is run, as `grainfall run` would read it.
    pub(super) fn scenario_of(&self, run: usize) -> Result<(Origin, Scenario), ProgramError> {
        let (combination, seed) = self.combination_of(run);
        let origin = self.origin_of(combination, Some(seed));
        let scenario = read_text(&origin)?;
        Ok((origin, scenario))
    }

    fn origin_of(&self, combination: usize, seed: Option<u64>) -> Origin {
        let mut origin = self.origin.clone();
        let indices = self.indices(combination);
        let values = self.variations.iter().zip(indices);
        origin.assignments = values
            .flat_map(|(variation, index)| variation.assignments(index).to_vec())
            .chain(seed.map(seed_is))
            .collect();
        origin
    }

    /// Which value of each variation a combination has.
    fn indices(&self, combination: usize) -> Vec<usize> {
        let mut left = combination;
        let mut indices: Vec<usize> = self
            .variations
            .iter()
            .rev()
            .map(|variation| {
                let count = variation.count();
                let index = left % count;
                left /= count;
                index
            })
            .collect();
        indices.reverse();
        indices
    }

    /// The values of a combination, in the order of the variations.
    pub(super) fn values_of(&self, combination: usize) -> Vec<String> {
        let indices = self.indices(combination);
        let values = self.variations.iter().zip(indices);
        values
            .map(|(variation, index)| plain(&variation.assignments(index)[0].value))
            .collect()
    }

    /// The values of a combination that are not those of all, for messages.
    fn values_text(&self, combination: usize) -> String {
        let values = self.variations.iter().zip(self.values_of(combination));
        let values: Vec<String> = values
            .filter(|(variation, _)| variation.is_varied())
            .map(|(variation, value)| format!("{} = {}", variation.title(), shortened(&value, 80)))
            .collect();
        values.join(", ")
    }
}

/// Refuses seeds among the values, and values that are given twice over.
fn check_paths(variations: &[Variation]) -> Result<(), SweepError> {
    let seed = Path::root().key("seed");
    let mut given: Vec<(&Path, &Variation)> = Vec::new();
    for variation in variations {
        for path in &variation.paths {
            if path.is_within(&seed) {
                return Err(SweepError::Seed);
            }
            if let Some((_, other)) = given.iter().find(|(other, _)| *other == path) {
                return Err(SweepError::Twice {
                    path: path.to_string(),
                    one: other.text.clone(),
                    other: variation.text.clone(),
                });
            }
            given.push((path, variation));
        }
    }
    Ok(())
}

/// How many combinations there are, if that many can be run.
fn count(variations: &[Variation], seeds: u64) -> Result<usize, SweepError> {
    let combinations = variations.iter().fold(1_u128, |product, variation| {
        product.saturating_mul(variation.count() as u128)
    });
    if combinations.saturating_mul(u128::from(seeds)) > u128::from(MOST_RUNS) {
        return Err(SweepError::TooMany {
            combinations,
            seeds,
            most: MOST_RUNS,
        });
    }
    Ok(combinations as usize)
}

impl Tasks for Plan {
    fn runs(&self) -> usize {
        Plan::runs(self)
    }

    fn folder_of(&self, run: usize) -> String {
        Plan::folder_of(self, run)
    }

    fn scenario_of(&self, run: usize) -> Result<(Origin, Scenario), ProgramError> {
        Plan::scenario_of(self, run)
    }
}
