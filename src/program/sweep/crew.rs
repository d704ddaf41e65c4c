//! Carries runs out on several threads, each run on one.

use std::fs;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use crate::output::RunFolder;
use crate::program::criteria::Program;
use crate::program::drive::{Options, scenario_text};
use crate::program::error::ProgramError;
use crate::program::progress::Gauge;
use crate::program::resume::continued;
use crate::program::run::Run;
use crate::program::signals::Signals;
use crate::program::sweep::error::SweepError;
use crate::program::sweep::outcome::Outcome;
use crate::scenario::{Origin, Scenario};

/// How often somebody looks how the runs are getting on.
const LOOK_EVERY: Duration = Duration::from_millis(200);
/// What the main thread of a process has, too.
const STACK: usize = 8 << 20;

/// Runs that are to be carried out.
pub(in crate::program) trait Tasks: Sync {
    /// How many.
    fn runs(&self) -> usize;

    /// The name of the folder of one.
    fn folder_of(&self, run: usize) -> String;

    /// What one is to do.
    fn scenario_of(&self, run: usize) -> Result<(Origin, Scenario), ProgramError>;
}

/// Who carries them out.
pub(in crate::program) struct Crew<'a, T> {
    pub(in crate::program) plan: &'a T,
    /// Where their folders stand.
    pub(in crate::program) folder: &'a Path,
    pub(in crate::program) threads: usize,
    pub(in crate::program) checkpoint_every: Option<f64>,
    pub(in crate::program) signals: &'a Signals,
    pub(in crate::program) program: &'a Program,
}

impl<T: Tasks> Crew<'_, T> {
    /// Takes one run after the other until none is left or a signal has come.
    /// Calls `look` with those that have ended and with how the others are
    /// getting on, now and then.
    pub(in crate::program) fn work(
        &self,
        mut look: impl FnMut(Vec<(usize, Outcome)>, &[Arc<Gauge>]),
    ) -> Result<(), ProgramError> {
        let next = AtomicUsize::new(0);
        let threads = self.threads.min(self.plan.runs());
        let gauges: Vec<Arc<Gauge>> = (0..threads).map(|_| Arc::default()).collect();
        let (tell, hear) = mpsc::channel();
        let next = &next;
        thread::scope(|scope| {
            for (number, gauge) in gauges.iter().enumerate() {
                let tell = tell.clone();
                let work = move || {
                    while self.signals.exit_code().is_none() {
                        let run = next.fetch_add(1, Ordering::Relaxed);
                        if run >= self.plan.runs() {
                            break;
                        }
                        let outcome = self.carry_out(run, gauge);
                        gauge.set(0.0);
                        if tell.send((run, outcome)).is_err() {
                            break;
                        }
                    }
                };
                let thread = thread::Builder::new().stack_size(STACK);
                match thread.spawn_scoped(scope, work) {
                    // Those that are there do the work.
                    Err(_) if number > 0 => break,
                    Err(error) => return Err(ProgramError::io("a thread")(error)),
                    Ok(_) => {}
                }
            }
            drop(tell);
            loop {
                match hear.recv_timeout(LOOK_EVERY) {
                    Ok(first) => {
                        let ended = std::iter::once(first).chain(hear.try_iter()).collect();
                        look(ended, &gauges);
                    }
                    Err(RecvTimeoutError::Timeout) => look(Vec::new(), &gauges),
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
            }
        })
    }

    fn carry_out(&self, run: usize, gauge: &Arc<Gauge>) -> Outcome {
        let folder = self.folder.join(self.plan.folder_of(run));
        let done = self.begin_or_go_on(run, &folder, gauge);
        Outcome::after(&folder, done)
    }

    fn begin_or_go_on(
        &self,
        run: usize,
        folder: &Path,
        gauge: &Arc<Gauge>,
    ) -> Result<(), ProgramError> {
        let (origin, scenario) = self.plan.scenario_of(run)?;
        let options = Options {
            checkpoint_every: self.checkpoint_every,
            audit: None,
            quiet: true,
            gauge: Some(Arc::clone(gauge)),
        };
        let file = folder.join("scenario.toml");
        match fs::read(&file) {
            Ok(found) if found == scenario_text(&scenario)? => {
                // Once collapsed it would collapse again.
                if !Outcome::read(folder).is_collapsed() {
                    continued(
                        RunFolder::open(folder)?,
                        options,
                        self.signals,
                        self.program,
                    )?;
                }
                Ok(())
            }
            Ok(_) => Err(SweepError::OtherRun {
                file: file.display().to_string(),
            }
            .into()),
            // What is there without it was cut off before it had begun.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let run = Run {
                    origin,
                    scenario,
                    folder,
                    force: true,
                    options,
                    program: self.program,
                };
                run.begin(self.signals).map(drop)
            }
            Err(error) => Err(ProgramError::io(file.display().to_string())(error)),
        }
    }
}
