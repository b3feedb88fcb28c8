//! A route in time: corners are rounded where what is driven is proven free.

use elbowroom_scene::SceneState;

use super::{Connect, Route, RouteError, RouteOptions};
use crate::timing::{Legs, MotionLimits, On, Trajectory};

/// So often the room of a corner is halved before the motion stops there.
const HALVINGS: i32 = 5;

impl Connect<'_> {
    /// Times a route within limits: straight along its legs, around its corners where that is proven free, else with a
    /// stop. What is proven is the polyline through the motion's positions at every `period` (s), which is what
    /// [`Trajectory::rows`] gives and a controller that goes straight between them drives. The motion rests at multiples of
    /// the period only.
    ///
    /// ```
    /// use elbowroom_planner::{Connect, MotionLimits, RouteOptions};
    /// use elbowroom_scene::{SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, 0, &[-0.9, 1.3, 0.6])?;
    /// let (mut connect, options) = (Connect::new(&scene, 0)?, RouteOptions::default());
    /// let route = connect.plan(&state, &[0.9, 1.3, 0.6], &options)?;
    /// let limits = MotionLimits { velocity: vec![2.0; 3], acceleration: vec![8.0; 3], jerk: vec![80.0; 3] };
    /// let motion = connect.time(&state, &route, &limits, 0.004, &options)?;
    /// let rows = motion.rows(0.004)?;
    /// assert_eq!(rows.last().unwrap().1, [0.9, 1.3, 0.6]);
    /// assert!(motion.seconds() > route.length_rad / 2.0_f64.hypot(2.0).hypot(2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Limits that are not one finite number above 0 per joint, such a period, or a route that is not one of this robot.
    pub fn time(
        &mut self,
        start: &SceneState,
        route: &Route,
        limits: &MotionLimits,
        period: f64,
        options: &RouteOptions,
    ) -> Result<Trajectory, RouteError> {
        self.ends(start, route.waypoints.last().map_or(&[], |q| q), options)?;
        let legs = Legs::new(&route.waypoints, limits)?;
        let mut rooms: Vec<f64> = (0..legs.count()).map(|n| if n > 0 { legs.half(n) } else { 0.0 }).collect();
        let least: Vec<f64> = rooms.iter().map(|room| room * 0.5_f64.powi(HALVINGS)).collect();
        loop {
            let motion = legs.clone().timed(&rooms).on_ticks(period)?;
            let refused = self.refused(&motion, period)?;
            if refused.is_empty() {
                return Ok(motion);
            }
            let before = rooms.clone();
            for n in refused {
                rooms[n] = if rooms[n] > least[n] { 0.5 * rooms[n] } else { 0.0 };
            }
            if rooms == before {
                // Not to be: where corners are stops, rows go from waypoint to waypoint.
                rooms.fill(0.0);
                return Ok(legs.timed(&rooms).on_ticks(period)?);
            }
        }
    }

    /// The corners at which the polyline through the rows is not proven free.
    fn refused(&mut self, motion: &Trajectory, period: f64) -> Result<Vec<usize>, RouteError> {
        let rows = motion.rows(period)?;
        let mut refused = Vec::new();
        for pair in rows.windows(2) {
            let ((t, a), (next, b)) = (&pair[0], &pair[1]);
            // A hair inside, as a stop is the end of one leg and the beginning of the next.
            let hair = 1e-6 * period;
            let (first, last) = match (motion.on(t + hair), motion.on(next - hair)) {
                // Both on one leg: that is proven.
                (Some(On::Leg(m)), Some(On::Leg(n))) if m == n => continue,
                (Some(On::Leg(m)), Some(On::Leg(n) | On::Corner(n))) => (m + 1, n),
                (Some(On::Corner(m)), Some(On::Leg(n) | On::Corner(n))) => (m, n),
                _ => continue,
            };
            let known = (first..=last).all(|n| refused.contains(&n));
            if !known && !self.way.proven(a, b) {
                refused.extend(first..=last);
            }
        }
        refused.sort_unstable();
        refused.dedup();
        Ok(refused)
    }
}
