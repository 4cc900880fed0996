//! How late what is placed may end for the rest to find room: the program along the loop, backwards.

use super::frontier::Label;
use super::program::{Free, LeavesRoom, Program};
use super::task::Task;
use std::collections::BTreeMap;
use std::ops::Range;

/// What two that touch may overlap by, m.
const TOUCH: f64 = 1e-9;

/// The latest places for some groups, by how many of each are left: as labels of the loop in the other direction.
struct Places {
    groups: Range<usize>,
    by_left: BTreeMap<Vec<usize>, Vec<Label>>,
}

/// The latest places for all that may be left.
pub struct Latest(Vec<Places>);

impl Latest {
    /// As if each group stood alone: a first sieve.
    pub fn alone(task: &Task, free: &Free) -> Latest {
        let (task, free) = backwards(task, free);
        let of = |g: usize| {
            let mut group = task.groups[g].clone();
            group.behind.clear();
            let own = Task { groups: vec![group], ..task.clone() };
            Places::new(&own, &vec![free[g].clone()], g..g + 1, &|_, _| true)
        };
        Latest((0..task.groups.len()).filter_map(of).collect())
    }

    /// With all groups. None where memory does not suffice.
    pub fn together(task: &Task, free: &Free) -> Option<Latest> {
        let (task, free) = backwards(task, free);
        let sieve = Latest::alone(&task, &free);
        let groups = 0..task.groups.len();
        Places::new(&task, &free, groups, &|left, label| sieve.leaves_room(left, label))
            .map(|places| Latest(vec![places]))
    }

    /// Whether so many of each group find room behind what was placed.
    pub fn leaves_room(&self, left: &[usize], label: &Label) -> bool {
        let behind = |rest: &Label| {
            let side = |k: usize| label.end[k] + label.service[k].max(rest.service[k]) <= TOUCH - rest.end[k];
            label.middle <= TOUCH - rest.middle && side(0) && side(1)
        };
        let all = |places: &Places| {
            let latest = places.by_left.get(&left[places.groups.clone()]);
            latest.is_some_and(|latest| latest.iter().any(behind))
        };
        self.0.iter().all(all)
    }
}

impl Places {
    fn new(task: &Task, free: &Free, groups: Range<usize>, leaves_room: &LeavesRoom) -> Option<Places> {
        let run = Program::of_room(task, free).leaving_room(leaves_room).run();
        let of = |(left, labels): (&Vec<usize>, &Range<usize>)| (left.clone(), run.labels[labels.clone()].to_vec());
        run.whole.then(|| Places { groups, by_left: run.by_placed.iter().map(of).collect() })
    }
}

/// The loop driven the other way: what lay at x is at -x, and what stood behind stands before.
fn backwards(task: &Task, free: &Free) -> (Task, Free) {
    let mut back = task.clone();
    back.stretches.iter_mut().for_each(|stretch| stretch.offset = -stretch.offset);
    let mut open: Free = Vec::new();
    for (g, group) in back.groups.iter_mut().enumerate() {
        group.behind = (0..task.groups.len()).filter(|other| task.groups[*other].behind.contains(&g)).collect();
        group.rooms.reverse();
        let stretch = group.of.stretch;
        let of_room =
            |room: &Vec<(f64, f64)>| room.iter().rev().map(|(low, high)| (-high - stretch, -low - stretch)).collect();
        open.push(free[g].iter().rev().map(of_room).collect());
    }
    (back, open)
}
