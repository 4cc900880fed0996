#[cfg(test)]
mod tests {
    use crate::model::thesis10::thesis10;
    use crate::problem::{Problem, Scope};
    use crate::solve::{perturb::perturbed, sqp};

    #[test]
    fn explore() {
        let layout = thesis10();
        for (scope, best) in [(Scope::Building, 157.19840), (Scope::Obstacles, 159.24619)] {
            let p = Problem::new(&layout, scope);
            if scope == Scope::Obstacles {
                let s = sqp::minimise(&p, &p.start, &Default::default(), &|_, _, _| {});
                let t = std::time::Instant::now();
                let d = crate::solve::discrete::discretise(&layout, &p, &s, &Default::default());
                let e = p.evaluate(&d.variables, 0.0);
                for r in &e.rows {
                    if r.violation() > 1e-6 {
                        println!(
                            "Building viol {:?} {:?} {:.3e} {} {} {}",
                            r.key,
                            p.describe(r.key).0,
                            r.violation(),
                            r.expansion.value,
                            r.low,
                            r.high
                        );
                    }
                }
                println!(
                    "Building turns {:?} {:?}",
                    e.track.fillets.iter().map(|f| f.turn.to_degrees()).collect::<Vec<_>>(),
                    e.track.fillets.iter().map(|f| f.radius).collect::<Vec<_>>()
                );

                println!(
                    "Building stage3 {:.6} {:.1e} it {} {:.1} ms",
                    d.length,
                    d.max_violation,
                    d.iterations,
                    t.elapsed().as_secs_f64() * 1e3
                );
            }
            for seed in 0..1u64 {
                let start = if seed == 0 { p.start.clone() } else { perturbed(&layout, &p, 1.5, seed) };
                let t = std::time::Instant::now();
                let s = sqp::minimise(&p, &start, &Default::default(), &|i, l, v| {
                    if std::env::var("V").is_ok() {
                        println!("   {i} {l:.6} {v:.2e}")
                    }
                });
                println!(
                    "{scope:?} {seed} {:.6} {:+.6} viol {:.1e} it {} conv {} {:.1} ms",
                    s.length,
                    s.length - best,
                    s.max_violation,
                    s.iterations,
                    s.converged,
                    t.elapsed().as_secs_f64() * 1e3
                );
            }
        }
    }
}
