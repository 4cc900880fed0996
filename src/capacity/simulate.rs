//! Carriers and items, carrier by carrier.
//!
//! A chain of equal carriers at one speed is a ring of slots: a place on the track sees the next carrier one pitch later,
//! always at the same phase of a step. So no queue of events is needed: in each step every place looks at the carrier that
//! passes, in the order of their phases. Stops of the chain move the clock on, not the carriers.

use super::outage::Outage;
use super::sorter::{Failures, Sorter, Waves};
use super::stream::{Cause, exponential, stream};
use super::warm_up;
use super::waves::{Turn, running_sums};
use crate::base::random::Random;
use crate::base::stop::Stop;
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;

/// Steps between two looks whether to stop.
const A_LOOK: u64 = 4096;

/// How long and from which random numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Simulated time, s.
    pub duration: f64,
    /// The same seed gives the same arrivals, destinations, stops and failures, whatever else of the sorter differs.
    pub seed: u64,
    /// Length of an interval of the series, s.
    pub interval: f64,
}

/// What was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Items given out in each interval.
    pub series: Vec<u32>,
    /// Items given out in each wave until they repeat, in whole cycles behind the first.
    pub waves: Vec<u64>,
    /// Items that wait at each induction at the end.
    pub queues: Vec<usize>,
    /// Items that came, were put on carriers, read and given out, or tried to be.
    pub events: u64,
    /// From the beginning to the end.
    pub counts: Counts,
    /// From the beginning to the begin of an interval, of those at which a warm-up may end.
    marks: BTreeMap<usize, Counts>,
}

/// What was counted in some time.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    pub inductions: Vec<InductionSeen>,
    pub chutes: Vec<ChuteSeen>,
    /// Items given out, and those of them at another chute than theirs.
    pub items: u64,
    pub misplaced: u64,
    /// Laps that items made in vain: no scanner had read it, or a chute was full, down, or closed between two waves.
    pub unread: u64,
    pub refused: u64,
    pub down: u64,
    pub closed: u64,
    /// Sum of the times from coming to being given out, s.
    pub time: f64,
}

impl Seen {
    /// What was counted from the beginning of one interval of the series to that of another, and whether that is known:
    /// else it is to the end. `kept` begins where a warm-up may end.
    pub fn within(&self, kept: &Range<usize>) -> (Counts, bool) {
        let (end, marked) = self.marks.get(&kept.end).map_or((&self.counts, false), |end| (end, true));
        let mut counts = end.clone();
        if let Some(begin) = self.marks.get(&kept.start) {
            counts.subtract(begin);
        }
        (counts, marked)
    }
}

impl Counts {
    fn new(sorter: &Sorter) -> Self {
        Counts {
            inductions: vec![InductionSeen::default(); sorter.inductions.len()],
            chutes: vec![ChuteSeen::default(); sorter.chutes.len()],
            items: 0,
            misplaced: 0,
            unread: 0,
            refused: 0,
            down: 0,
            closed: 0,
            time: 0.0,
        }
    }

    fn subtract(&mut self, before: &Counts) {
        for (now, was) in self.inductions.iter_mut().zip(&before.inductions) {
            now.items -= was.items;
            now.passed -= was.passed;
            now.free -= was.free;
            now.down -= was.down;
            now.waited -= was.waited;
        }
        for (now, was) in self.chutes.iter_mut().zip(&before.chutes) {
            now.items -= was.items;
            now.refused -= was.refused;
            now.down -= was.down;
            now.closed -= was.closed;
        }
        self.items -= before.items;
        self.misplaced -= before.misplaced;
        self.unread -= before.unread;
        self.refused -= before.refused;
        self.down -= before.down;
        self.closed -= before.closed;
        self.time -= before.time;
    }
}

/// What an induction saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InductionSeen {
    pub items: u64,
    /// Carriers that passed, and those of them that were free before it.
    pub passed: u64,
    pub free: u64,
    /// Carriers that passed while it was down.
    pub down: u64,
    /// Sum of the times that items waited, s.
    pub waited: f64,
}

/// What a chute saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChuteSeen {
    pub items: u64,
    /// Items that came and found it full, down, or closed between two waves.
    pub refused: u64,
    pub down: u64,
    pub closed: u64,
}

impl ChuteSeen {
    /// Items that came, as often as they did.
    pub fn came(&self) -> u64 {
        self.items + self.refused + self.down + self.closed
    }
}

/// Whether an item's chute is known.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    Yes,
    /// No scanner has had it yet.
    NotYet,
    /// One has, in vain.
    Missed,
}

/// A carrier's load.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Load {
    Free,
    /// The index of a chute, whether it is known yet, laps in vain, and the time at which the item came.
    Item {
        chute: u32,
        known: Known,
        laps: u32,
        came: f64,
        double: bool,
    },
    /// The second carrier of the item before it.
    Second,
    /// The same, when that item has been given out at this chute.
    Left {
        chute: u32,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Induction(usize),
    Chute(usize),
    Scanner(usize),
}

/// A place on the track.
#[derive(Clone, Copy, Debug)]
struct Place {
    kind: Kind,
    /// Of the carrier that passes in step 0.
    carrier: usize,
    /// Of a step, from 0 to 1.
    phase: f64,
}

/// An induction's queue.
struct Feed {
    random: Random,
    kinds: Random,
    used: Random,
    /// When the next item comes, s; items that wait.
    next: f64,
    waiting: VecDeque<f64>,
    /// When it can put the next one on a carrier, s.
    ready: f64,
    /// The head of the queue: whether it needs two carriers.
    double: bool,
}

impl Feed {
    fn new(sorter: &Sorter, seed: u64, index: usize) -> Feed {
        let mut random = stream(seed, Cause::Arrivals, index);
        let next = sorter.inductions[index].demand.map_or(0.0, |rate| exponential(&mut random, 3600.0 / rate));
        let mut kinds = stream(seed, Cause::Doubles, index);
        let double = kinds.uniform() < sorter.items.double;
        let used = stream(seed, Cause::Used, index);
        Feed { random, kinds, used, next, waiting: VecDeque::new(), ready: 0.0, double }
    }
}

/// Simulates from an empty sorter.
pub fn simulate(sorter: &Sorter, plan: &Plan, stop: Stop) -> Seen {
    let mut places: Vec<Place> = Vec::new();
    let mut place = |kind: Kind, s: f64| {
        let at = s.rem_euclid(sorter.length()) / sorter.pitch;
        let carrier = at.floor();
        places.push(Place { kind, carrier: carrier as usize % sorter.carriers, phase: at - carrier });
    };
    (0..sorter.inductions.len()).for_each(|i| place(Kind::Induction(i), sorter.inductions[i].s));
    (0..sorter.chutes.len()).for_each(|i| place(Kind::Chute(i), sorter.chutes[i].s));
    (0..sorter.scanners.len()).for_each(|i| place(Kind::Scanner(i), sorter.scanners[i].s));
    places.sort_by(|a, b| a.phase.total_cmp(&b.phase));
    let outages = |cause: Cause, fails: &mut dyn Iterator<Item = Option<&Failures>>| -> Vec<Option<Outage>> {
        let one = |(k, fails): (usize, Option<&Failures>)| fails.map(|f| Outage::new(f, stream(plan.seed, cause, k)));
        fails.enumerate().map(one).collect()
    };
    let waves = sorter.waves.as_ref();
    let steps_per_second = sorter.speed / sorter.pitch;
    let mut run = Run {
        sorter,
        reads: stream(plan.seed, Cause::Reads, 0),
        destinations: (0..sorter.inductions.len()).map(|i| stream(plan.seed, Cause::Destinations, i)).collect(),
        feeds: (0..sorter.inductions.len()).map(|i| Feed::new(sorter, plan.seed, i)).collect(),
        outages: outages(Cause::Inductions, &mut sorter.inductions.iter().map(|i| i.fails.as_ref())),
        chute_outages: outages(Cause::Chutes, &mut sorter.chutes.iter().map(|c| c.fails.as_ref())),
        scanner_outages: outages(Cause::Scanners, &mut sorter.scanners.iter().map(|s| s.fails.as_ref())),
        closed: 0.0,
        counted: None,
        loads: vec![Load::Free; sorter.carriers],
        contents: vec![VecDeque::new(); sorter.chutes.len()],
        shares: running_sums(sorter, &sorter.shares(0)),
        interval: plan.interval,
        seen: Seen {
            series: vec![0; (plan.duration / plan.interval).ceil() as usize],
            waves: vec![0; waves.map_or(0, Waves::count)],
            queues: Vec::new(),
            events: 0,
            counts: Counts::new(sorter),
            marks: BTreeMap::new(),
        },
    };
    let cycle = waves.map_or(usize::MAX, |waves| (waves.cycle() / plan.interval).round().max(1.0) as usize);
    let mut begun = 0usize;
    let mut stops = stream(plan.seed, Cause::Stops, 0);
    let mut stopped = 0.0;
    let mut fails = sorter.stops.map_or(f64::INFINITY, |s| exponential(&mut stops, s.between));
    let mut turn = waves.map(|waves| Turn::new(sorter, waves, stream(plan.seed, Cause::Waves, 0)));
    let cycles = waves.map_or(0, |waves| (plan.duration / waves.cycle()) as u64);
    let step = 1.0 / steps_per_second;
    // Carriers move on by one place a step; counted so that no division is needed.
    let mut shift = 0usize;
    let mut m = 0u64;
    loop {
        let running = m as f64 * step;
        if let Some(s) = sorter.stops {
            while running >= fails {
                stopped += exponential(&mut stops, s.duration);
                fails += exponential(&mut stops, s.between);
            }
        }
        let now = running + stopped;
        if now >= plan.duration || (m.is_multiple_of(A_LOOK) && stop.now()) {
            break;
        }
        while now >= begun as f64 * plan.interval {
            if begun.is_multiple_of(warm_up::BATCH) || begun.is_multiple_of(cycle) {
                run.seen.marks.insert(begun, run.seen.counts.clone());
            }
            begun += 1;
        }
        if let Some(turn) = &mut turn {
            while now >= turn.next() {
                (run.closed, run.shares) = turn.begin();
                run.contents.iter_mut().for_each(VecDeque::clear);
                let (cycle, wave) = turn.at();
                run.counted = (cycle > 0 && cycle < cycles).then_some(wave);
            }
        }
        for place in &places {
            let k = place.carrier + sorter.carriers - shift;
            let k = if k >= sorter.carriers { k - sorter.carriers } else { k };
            let time = now + place.phase * step;
            match place.kind {
                Kind::Induction(i) => run.induce(i, k, time),
                Kind::Chute(c) => run.give_out(c, k, time),
                Kind::Scanner(i) => run.read(i, k, time),
            }
        }
        shift = if shift + 1 == sorter.carriers { 0 } else { shift + 1 };
        m += 1;
    }
    run.seen.queues = run.feeds.iter().map(|feed| feed.waiting.len()).collect();
    run.seen
}

struct Run<'a> {
    sorter: &'a Sorter,
    reads: Random,
    destinations: Vec<Random>,
    feeds: Vec<Feed>,
    outages: Vec<Option<Outage>>,
    chute_outages: Vec<Option<Outage>>,
    scanner_outages: Vec<Option<Outage>>,
    /// Until when chutes take nothing, s.
    closed: f64,
    /// The wave whose items are counted.
    counted: Option<usize>,
    loads: Vec<Load>,
    /// When the items of each chute are taken away, s.
    contents: Vec<VecDeque<f64>>,
    /// Running sums of the chutes' shares, by induction.
    shares: Vec<Vec<f64>>,
    interval: f64,
    seen: Seen,
}

impl Run<'_> {
    fn induce(&mut self, i: usize, k: usize, now: f64) {
        let induction = &self.sorter.inductions[i];
        let feed = &mut self.feeds[i];
        let seen = &mut self.seen.counts.inductions[i];
        if let Some(rate) = induction.demand {
            while feed.next <= now {
                feed.waiting.push_back(feed.next);
                feed.next += exponential(&mut feed.random, 3600.0 / rate);
                self.seen.events += 1;
            }
        }
        seen.passed += 1;
        let down = self.outages[i].as_mut().is_some_and(|outage| outage.is_down(now));
        seen.down += u64::from(down);
        if self.loads[k] != Load::Free {
            return;
        }
        seen.free += 1;
        if down {
            return;
        }
        let came = match induction.demand {
            Some(_) => feed.waiting.front().copied(),
            None => Some(now),
        };
        let Some(came) = came else { return };
        if now < feed.ready || (induction.efficiency < 1.0 && feed.used.uniform() >= induction.efficiency) {
            return;
        }
        // The carrier behind passes one step later.
        let behind = if k == 0 { self.loads.len() - 1 } else { k - 1 };
        if feed.double && self.loads[behind] != Load::Free {
            return;
        }
        let chute = pick(&self.shares[i], self.destinations[i].uniform());
        let known = if self.sorter.scanners.is_empty() { Known::Yes } else { Known::NotYet };
        self.loads[k] = Load::Item { chute, known, laps: 0, came, double: feed.double };
        if feed.double {
            self.loads[behind] = Load::Second;
        }
        feed.double = feed.kinds.uniform() < self.sorter.items.double;
        feed.waiting.pop_front();
        // One item stands ready: what a carrier was late for the last is made up with the next.
        let each = if induction.most.is_finite() { 3600.0 / induction.most } else { 0.0 };
        feed.ready = feed.ready.max(now - each) + each;
        seen.items += 1;
        seen.waited += now - came;
        self.seen.events += 1;
    }

    fn read(&mut self, i: usize, k: usize, now: f64) {
        let Load::Item { known, .. } = &mut self.loads[k] else { return };
        if *known == Known::Yes {
            return;
        }
        self.seen.events += 1;
        let fails = self.sorter.items.no_read > 0.0 && self.reads.uniform() < self.sorter.items.no_read;
        let down = self.scanner_outages[i].as_mut().is_some_and(|outage| outage.is_down(now));
        *known = if fails || down { Known::Missed } else { Known::Yes };
    }

    fn give_out(&mut self, c: usize, k: usize, now: f64) {
        match &mut self.loads[k] {
            Load::Item { chute, known, laps, came, double } => {
                let given_up = *laps as usize >= self.sorter.items.most_laps;
                let here = *chute as usize == c;
                if here && *known == Known::Missed && !given_up {
                    // It passes its chute, which no scanner could tell.
                    *laps += 1;
                    *known = Known::NotYet;
                    self.seen.counts.unread += 1;
                    return;
                }
                let own = here && *known == Known::Yes;
                if !(own || given_up) {
                    return;
                }
                self.seen.events += 1;
                let (came, double) = (*came, *double);
                let closed = now < self.closed;
                if closed || self.chute_outages[c].as_mut().is_some_and(|outage| outage.is_down(now)) {
                    // One that would leave anywhere goes on to the next chute.
                    if own {
                        *laps += 1;
                        let (closed, down) = (u64::from(closed), u64::from(!closed));
                        self.seen.counts.closed += closed;
                        self.seen.counts.down += down;
                        self.seen.counts.chutes[c].closed += closed;
                        self.seen.counts.chutes[c].down += down;
                    }
                    return;
                }
                if let Some((most, seconds)) = self.sorter.chutes[c].storage {
                    let content = &mut self.contents[c];
                    while content.front().is_some_and(|leaves| *leaves <= now) {
                        content.pop_front();
                    }
                    if content.len() >= most {
                        *laps += 1;
                        self.seen.counts.chutes[c].refused += 1;
                        self.seen.counts.refused += 1;
                        return;
                    }
                    let begins = content.back().copied().unwrap_or(now).max(now);
                    content.push_back(begins + seconds);
                }
                self.loads[k] = Load::Free;
                if double {
                    let behind = if k == 0 { self.loads.len() - 1 } else { k - 1 };
                    self.loads[behind] = Load::Left { chute: c as u32 };
                }
                self.seen.counts.chutes[c].items += 1;
                self.seen.counts.items += 1;
                self.seen.counts.misplaced += u64::from(!here);
                self.seen.counts.time += now - came;
                if let Some(wave) = self.counted {
                    self.seen.waves[wave] += 1;
                }
                if let Some(count) = self.seen.series.get_mut((now / self.interval) as usize) {
                    *count += 1;
                }
            }
            Load::Left { chute } if *chute as usize == c => self.loads[k] = Load::Free,
            _ => {}
        }
    }
}

/// The first whose running sum is above a share of all.
fn pick(sums: &[f64], share: f64) -> u32 {
    let at = share * sums.last().copied().unwrap_or(0.0);
    sums.partition_point(|sum| *sum <= at).min(sums.len().saturating_sub(1)) as u32
}
