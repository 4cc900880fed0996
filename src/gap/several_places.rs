//! An effect at several places: places are added one by one beside the best, and where several were found, each is
//! tried in the other shapes of its place while the others are held (coordinate descent). The shape of a place that was
//! found while others were missing is a compromise with these.

use super::comparison::Comparison;
use super::hypothesis::{Fitted, Hypothesis, norm_squared};
use super::ids::PerRun;
use super::relinearisation::{at_alternatives, turned};
use super::scored::Scored;
use super::signature::{Explained, Runs, Signature, Trial, explain, take};
use nalgebra::DVector;

impl Comparison<'_> {
    /// The effect that leaves least of those that were simulated alone and may be at several places, at one place more,
    /// where it explains something; and what it leaves without it, as a mean square. Where it strikes, with the other
    /// sign and other shapes of that place, too: the known signatures are those that tell more of the nominal model's
    /// residual, in which the other places drown it.
    pub fn one_place_more(&mut self, scored: &[Scored]) -> Option<(Vec<Fitted>, f64)> {
        let candidates = self.candidates();
        let alone = |j: &&Scored| {
            let hypothesis = &j.fitted.hypothesis;
            let several = candidates[hypothesis.members[0]].several && self.effects(hypothesis).len() == 1;
            several && j.fitted.simulated() && self.explains(j.mean_square)
        };
        let first = scored.iter().filter(alone).min_by(|a, b| a.mean_square.total_cmp(&b.mean_square))?;
        let own = &candidates[first.fitted.hypothesis.members[0]].effect;
        let more = self.beside(&first.fitted, |c| candidates[c].effect == *own).into_iter().next()?.fitted;
        let otherwise = self.last_otherwise(&first.fitted, &more);
        Some(([more].into_iter().chain(otherwise).collect(), first.mean_square))
    }

    /// A hypothesis whose last member was added to a first one, with that member's strength of the other sign, and with
    /// its alternatives, by signatures of their own: those that explain most of what the first leaves. None where it
    /// does not strike.
    fn last_otherwise(&mut self, first: &Fitted, more: &Fitted) -> Vec<Fitted> {
        let (Some(own), Some(&size)) = (more.hypothesis.signatures.last(), more.strengths.last()) else {
            return Vec::new();
        };
        let signature = &self.signatures[*own];
        if size == 0.0 || !self.strikes(signature) {
            return Vec::new();
        }
        let mut trials = at_alternatives(self.context(), signature, size);
        trials.push(turned(self.context(), signature, size));
        let taken = take(self.context(), &self.observations, &trials, Runs::All, &mut |_| {});
        let mut taken: Vec<Signature> =
            taken.into_iter().filter(|(_, whole)| *whole).map(|(signature, _)| signature).collect();
        taken.sort_by(|a, b| b.explains(&first.residuals).total_cmp(&a.explains(&first.residuals)));
        // The others are not kept: scores count how many signatures there are.
        taken.truncate(self.settings.selection.place_shapes);
        let joined = taken.into_iter().map(|signature| {
            let members = vec![signature.candidate];
            let signatures = vec![self.signatures.push(signature)];
            self.joined(first, &Hypothesis { members, signatures })
        });
        let found: Vec<Fitted> = joined.collect();
        found.into_iter().filter(|fitted| fitted.all_there(&self.signatures)).collect()
    }

    /// The places of an effect that were found together and leave least, of those that explain something.
    pub fn several_places<'b>(&self, scored: &'b [Scored]) -> Option<&'b Scored> {
        let together = |j: &&Scored| {
            let hypothesis = &j.fitted.hypothesis;
            let several = hypothesis.members.len() > 1 && self.effects(hypothesis).len() == 1;
            several && hypothesis.signatures.len() == hypothesis.members.len() && j.fitted.simulated()
        };
        let found = scored.iter().filter(together).filter(|j| self.explains(j.mean_square));
        found.min_by(|a, b| a.mean_square.total_cmp(&b.mean_square))
    }

    /// The same places with one of them in the shape beside it that leaves least while the others are held: by its
    /// signature, and only where that gains as much as another simulation is worth.
    pub fn reshaped(&mut self, fitted: &Fitted, member: usize) -> Option<Fitted> {
        let own = &self.signatures[*fitted.hypothesis.signatures.get(member)?];
        let size = *fitted.strengths.get(member)?;
        let first = Signature { candidate: self.place(own.candidate), ..own.clone() };
        let mut trials = at_alternatives(self.context(), &first, size);
        trials.push(Trial { size, ..first.trial() });
        trials.retain(|trial| trial.size * size > 0.0 && trial.candidate != own.candidate);
        let taken = take(self.context(), &self.observations, &trials, Runs::All, &mut |_| {});
        let shapes = taken.into_iter().filter(|(_, whole)| *whole).map(|(shape, _)| {
            let explained = self.with_shape(fitted, member, &shape);
            (shape, explained)
        });
        let (shape, explained) =
            shapes.min_by(|a, b| norm_squared(&a.1.residuals).total_cmp(&norm_squared(&b.1.residuals)))?;
        let enough = (1.0 - self.settings.refitting.enough) * norm_squared(&fitted.residuals);
        (norm_squared(&explained.residuals) < enough).then(|| self.in_shape(fitted, member, shape, explained))
    }

    /// What all strengths come to with another shape of a member.
    fn with_shape(&self, fitted: &Fitted, member: usize, shape: &Signature) -> Explained {
        let without = fitted.residuals.iter().zip(fitted.direction()).map(|(left, along)| left + along).collect();
        let mut columns: Vec<&PerRun<DVector<f64>>> = fitted.columns.iter().collect();
        columns[member] = &shape.columns;
        explain(&without, &columns, &fitted.hypothesis.bounds(self.candidates(), &self.signatures), None)
    }

    /// With this shape of a member, and strengths that fit.
    fn in_shape(&mut self, fitted: &Fitted, member: usize, shape: Signature, explained: Explained) -> Fitted {
        let mut columns = fitted.columns.clone();
        columns[member].clone_from(&shape.columns);
        let mut hypothesis = fitted.hypothesis.clone();
        hypothesis.members[member] = shape.candidate;
        hypothesis.signatures[member] = self.signatures.push(shape);
        let back: Vec<f64> = fitted.strengths.iter().map(|x| -x).collect();
        let changes = fitted.hypothesis.changed_further(&self.signatures, &fitted.changes, &back);
        let changes = hypothesis.changed_further(&self.signatures, &changes, &explained.strengths);
        hypothesis.foretold(&self.observations, explained, columns, changes)
    }
}
