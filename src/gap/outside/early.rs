//! What the first answers show: whether the same question has the same answer, and whether a parameter does anything.

use super::data::RunPart;
use super::fit::left;
use super::model_error::by_second_differences;
use super::{Error, Outside, Rows};
use crate::base::number::significant;
use crate::gap::Applied;

impl Outside {
    /// Asks a run again, of a fresh process.
    ///
    /// # Errors
    ///
    /// [`Error::Random`] where the answers differ by more than the measured noise.
    pub(super) fn is_the_same(&self, part: &RunPart, at: &[f64], rows: &Rows) -> Result<(), Error> {
        self.differs(part, at, rows).map(|_| ())
    }

    /// By how much each channel differs when a fresh process is asked again, where that is less than its noise.
    fn differs(&self, part: &RunPart, at: &[f64], rows: &Rows) -> Result<Vec<f64>, Error> {
        self.pool.renew();
        let again = self.ask(part, at, &[])?;
        let noise = left(part, rows);
        let each = self.names.iter().zip(rows).zip(&again).zip(&noise);
        each.map(|(((channel, a), b), left)| {
            let squares: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).filter(|x| x.is_finite()).collect();
            let by = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
            let noise = by_second_differences(left).sqrt();
            if by > noise && by > 0.0 {
                return Err(Error::Random { channel: channel.clone(), by, noise });
            }
            Ok(by)
        })
        .collect()
    }

    /// Remarks on randomness, and on parameters that do nothing in a run.
    pub(super) fn ignored(&mut self, part: &RunPart, at: &[f64], rows: &Rows) {
        if let Ok(by) = self.differs(part, at, rows)
            && let Some((channel, by)) = self.names.iter().zip(by).find(|(_, by)| *by > 0.0)
        {
            self.random = true;
            let unit = self.channels.get(channel).cloned().unwrap_or_default();
            self.remarks.push(format!(
                "Asked the same twice, the model answers differently ({channel} by {} {unit}, less than its noise): that \
                 counts as noise, and slopes are taken over larger steps. A fixed seed would see more.",
                significant(by, 2)
            ));
        }
        let mut idle: Vec<String> = Vec::new();
        for (k, nuisance) in self.description.nuisances.iter().enumerate() {
            let mut moved = at.to_vec();
            moved[k] = if at[k] < 0.5 { at[k] + 0.1 } else { at[k] - 0.1 };
            if self.ask(part, &moved, &[]).is_ok_and(|other| other == *rows) {
                idle.push(nuisance.name.clone());
            }
        }
        for (candidate, effect) in self.description.effects.with_ids() {
            for (k, strength) in effect.strengths.iter().enumerate() {
                let mut strengths = vec![0.0; effect.strengths.len()];
                strengths[k] = strength.trial;
                if self.ask(part, at, &[Applied { candidate, strengths }]).is_ok_and(|other| other == *rows) {
                    idle.push(format!("{}.{}", effect.effect, strength.name));
                }
            }
        }
        if !idle.is_empty() {
            self.remarks.push(format!(
                "The model answers the same whatever is asked of {} in run {}: look whether it reads what it is told.",
                idle.join(", "),
                part.name
            ));
        }
    }
}
