//! Values of signals, and of measures that are computed from them, at the solver's pose.

use crate::kinematics::forces::Forces;
use crate::kinematics::path::Rates;
use crate::kinematics::solver::Solver;
use crate::mechanism::{Jet, Order, ParameterId, Signal};

impl Solver {
    /// Returns value, velocity and acceleration of a signal. Velocity and acceleration have a
    /// meaning only if `rates` and `driver_rates` belong to the pose. Allocates nothing.
    #[inline]
    #[must_use]
    pub fn signal(&self, signal: Signal, rates: &Rates, driver_rates: &[Jet]) -> Jet {
        match signal {
            Signal::Body(body, component) => {
                let column = 3 * body.index() + component;
                let derivatives = [rates.velocity()[column], rates.acceleration()[column]];
                Jet::new(self.pose().q[column], derivatives)
            }
            Signal::Marker(marker, component) => self.marker(marker, rates)[component],
            Signal::Measure(measure) => self.measure(measure, rates),
            Signal::Motion(driver) => match &self.compiled.named[driver.index()] {
                Some(own) => self.coordinate(&**own, rates),
                None => Jet {
                    value: self.pose().drivers[driver.index()],
                    ..driver_rates[driver.index()]
                },
            },
        }
    }

    /// Returns the value of a measure that is computed from others, by its index in
    /// [`Mechanism::derived`](crate::mechanism::Mechanism::derived). The rates are those of
    /// [`signal`](Self::signal), `forces` those of the pose. Not finite where it has no value, or for
    /// want of a force. Allocates nothing.
    #[must_use]
    pub fn derived(
        &self,
        index: usize,
        rates: &Rates,
        driver_rates: &[Jet],
        forces: Option<&Forces>,
    ) -> f64 {
        self.mechanism().derived[index].evaluate(
            &|parameter: ParameterId| self.pose().parameters[parameter.index()],
            &|signal, order: Order| order.of(self.signal(signal, rates, driver_rates)),
            &|quantity| forces.map_or(f64::NAN, |forces| forces.value(quantity)),
        )
    }
}
