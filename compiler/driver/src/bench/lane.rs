//! What is measured: a lane is one way to run a program on memory of its own, cycle by cycle with the same inputs.

use plcc_runtime::clock::Tick;
use plcc_runtime::engine::{Engine, Region};
use plcc_runtime::image::Task;
use plcc_runtime::stimulus::Stimulus;
use plcc_runtime::task::Schedule;
use std::rc::Rc;

/// A program that can be run cycle by cycle, and again from its start. Cycles count from 0 and come in order.
pub trait Cycle {
    /// Initial values; the next cycle is 0.
    fn restart(&mut self);

    /// The inputs of a cycle.
    fn feed(&mut self, cycle: u64);

    /// Executes a cycle: 0, or the number of a fault.
    fn execute(&mut self, cycle: u64) -> u32;

    /// Several cycles with their inputs, in one call so that nothing but them is measured.
    fn run(&mut self, first: u64, count: u64) -> u32 {
        let mut status = 0;
        for cycle in first..first + count {
            self.feed(cycle);
            status |= self.execute(cycle);
        }
        status
    }

    /// The memory.
    fn memory(&self) -> &Region;
}

/// A lane of a report.
pub struct Lane<'a> {
    /// Its name, the same in every program of a report.
    pub name: &'static str,
    /// What runs.
    pub subject: Box<dyn Cycle + 'a>,
}

/// Inputs of a fixed number of bytes for each cycle, which repeat.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Where in the region.
    pub offset: usize,
    /// Bytes a cycle.
    pub bytes: usize,
    /// One row after the other; lanes with equal rows share them.
    pub table: Rc<Vec<u8>>,
}

impl Rows {
    /// The inputs of a cycle.
    pub fn row(&self, cycle: u64) -> &[u8] {
        if self.bytes == 0 {
            return &[];
        }
        let rows = self.table.len() / self.bytes;
        let at = cycle as usize % rows * self.bytes;
        &self.table[at..at + self.bytes]
    }
}

/// The only task of a program, with [`Rows`] as inputs.
pub struct OneTask<E> {
    engine: E,
    region: Region,
    rows: Rows,
    interval_ns: i64,
}

impl<E: Engine> OneTask<E> {
    /// A program on a region of `region_bytes`.
    pub fn new(engine: E, region_bytes: usize, rows: Rows, interval_ns: i64) -> Self {
        Self { engine, region: Region::new(region_bytes), rows, interval_ns }
    }
}

impl<E: Engine> Cycle for OneTask<E> {
    fn restart(&mut self) {
        self.region.as_mut_slice().fill(0);
        self.engine.init(&mut self.region, true);
    }

    fn feed(&mut self, cycle: u64) {
        let row = self.rows.row(cycle);
        self.region.as_mut_slice()[self.rows.offset..][..row.len()].copy_from_slice(row);
    }

    fn execute(&mut self, cycle: u64) -> u32 {
        self.engine.scan(&mut self.region.whole(), 0, cycle as i64 * self.interval_ns)
    }

    fn memory(&self) -> &Region {
        &self.region
    }
}

/// All tasks of an application, released as `plcc run --virtual-time` releases them, with a stimulus.
pub struct AllTasks<E> {
    engine: E,
    region: Region,
    tasks: Vec<Task>,
    schedule: Schedule,
    stimulus: Option<Stimulus>,
    interval_ns: i64,
    /// The task that faulted last.
    pub faulted: usize,
}

impl<E: Engine> AllTasks<E> {
    /// An application on a region of `region_bytes`.
    pub fn new(engine: E, region_bytes: usize, tasks: &[Task], stimulus: Option<Stimulus>, interval_ns: i64) -> Self {
        Self {
            engine,
            region: Region::new(region_bytes),
            tasks: tasks.to_vec(),
            schedule: Schedule::new(tasks),
            stimulus,
            interval_ns,
            faulted: 0,
        }
    }

    /// The region, to be watched while it runs.
    pub fn region_mut(&mut self) -> &mut Region {
        &mut self.region
    }
}

impl<E: Engine> Cycle for AllTasks<E> {
    fn restart(&mut self) {
        self.region.as_mut_slice().fill(0);
        self.engine.init(&mut self.region, true);
        self.schedule = Schedule::new(&self.tasks);
        if let Some(stimulus) = &mut self.stimulus {
            stimulus.rewind();
        }
    }

    fn feed(&mut self, cycle: u64) {
        if let Some(stimulus) = &mut self.stimulus {
            stimulus.apply(cycle + 1, self.region.as_mut_slice());
        }
    }

    fn execute(&mut self, cycle: u64) -> u32 {
        let Self { engine, region, schedule, interval_ns, faulted, .. } = self;
        let now_ns = cycle as i64 * *interval_ns;
        schedule.sample(|at| region.as_slice().get(at as usize).copied().unwrap_or(0));
        let ran = schedule.release(Tick::at(now_ns), |task| {
            let status = engine.scan(&mut region.whole(), task as u32, now_ns);
            *faulted = task;
            if status == 0 { Ok(()) } else { Err(status) }
        });
        ran.err().unwrap_or(0)
    }

    fn memory(&self) -> &Region {
        &self.region
    }
}
