//! Cams.

use super::*;

/// A cam, by its contour.
#[derive(Clone, Debug, PartialEq)]
pub struct Cam {
    /// Its axle.
    pub at: Anchor,
    /// The contour, closed, in the frame of the anchor's body \[m\].
    pub contour: Vec<[f64; 2]>,
}

/// Stride through the sample angles of a profile: chords of 1.5° are drawn.
const STRIDE: usize = 3;

/// Composes a cam and the part of its follower that touches it.
pub(super) fn compose(
    composer: &mut Composer,
    [cam, follower]: [Anchor; 2],
    contact: &CamFollower,
    profile: &Profile,
) {
    let contour = contour(composer, cam, profile);
    match contact {
        CamFollower::Knife => knife::compose(composer, follower, cam),
        CamFollower::Roller { radius } => roller::compose(composer, follower, radius),
        CamFollower::Flat => face::compose(composer, follower, cam, &contour),
    }
    composer.add(Cam { at: cam, contour });
}

/// Returns a cam's contour in the frame of its body \[m\].
fn contour(composer: &Composer, cam: Anchor, profile: &Profile) -> Vec<[f64; 2]> {
    let mut in_force = ProfileInForce::new(profile, composer.mechanism.parameters.len());
    in_force
        .set_parameters(|p| composer.parameter(p))
        .expect("the mechanism was assembled with these parameters");
    let center = Point::from(cam.position);
    let point = |theta: f64| {
        let radius = in_force.radius(theta).value;
        center + radius * direction(cam.angle + theta)
    };
    let angles = ProfileInForce::sample_angles().step_by(STRIDE);
    angles.map(|theta| point(theta).into()).collect()
}

impl Shape for Cam {
    fn draw(&self, pen: &mut Pen) {
        let (axle, _, colour) = pen.on(self.at);
        let corners = self.contour.iter();
        let points: Vec<Point> = corners
            .map(|&position| pen.place(self.at.moved_to(position)).0)
            .collect();
        let outline = Outline::polygon(&points);
        pen.area(Layer::Wheel, outline, (colour, 0.3), Some(colour));
        // Places for the name: inside, best on the far side from the axle, or around.
        let middle = points.iter().sum::<Point>() / points.len() as f64;
        let distances = points.iter().map(|p| (p - middle).norm());
        let (least, most) = distances.fold((f64::INFINITY, 0.0_f64), |(least, most), d| {
            (least.min(d), most.max(d))
        });
        let away = unit(middle - axle);
        for (part, cost) in [(0.5, 0.0), (0.35, 1.0), (0.65, 1.0)] {
            let turns = [0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5];
            let places = turns.map(|turn| {
                let aside = direction(turn);
                let side = aside.x * away + aside.y * across(away);
                Candidate {
                    anchor: middle + part * least * side,
                    side: None,
                    gap: 0.0,
                    cost: cost + f64::abs(turn) - ON_WHEEL,
                }
            });
            pen.offer(self.at.body, places);
        }
        pen.offer(self.at.body, Candidate::around(middle, most + 1.0));
    }

    fn extent(&self) -> Vec<Disc> {
        let points = self.contour.iter();
        points.map(|&p| self.at.moved_to(p).into()).collect()
    }

    fn shows(&self) -> Option<BodyId> {
        self.at.body
    }

    fn covers(&self, point: Point) -> bool {
        let corners = self.contour.iter().map(|&p| Point::from(p));
        let ends = corners.clone().cycle().skip(1);
        contains(corners.zip(ends).map(|(a, b)| [a, b]), point)
    }
}
