//! Live views of a control loop in a browser.

use crate::figure::to_double;
use crate::motion::placement_in_double;
use crate::server::PageServer;
use crate::{Error, Figure, Motion, Page};
use linkwork::nalgebra::UnitQuaternion;
use linkwork::simulate::Sample;
use linkwork::{Drawn, Mechanism};

/// Live view: a page, served on this machine, that shows the samples which a running program
/// [sends](Live::show).
///
/// The page is that of [`Page`]. It can replay the last twenty seconds while the loop continues. Up to
/// sixteen browsers may be connected. The page is accessible from this machine only, and only pages of its
/// own origin may open the socket.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork_view::Live;
///
/// #[mechanism(gravity = -9.81 * y, drawing)]
/// struct Pendulum {
///     #[body(mass = 1, com = y, inertia = rod(1, 2, y))]
///     bob: Body,
///     #[joint(ground -> bob, about = z)]
///     hinge: Pin,
/// }
///
/// // Port 0 selects any free port.
/// let mut live = Live::open(&Pendulum {}, 0)?;
/// println!("open {}", live.url());
/// for sample in simulate(&Pendulum {}).from([3.0], [0.0]).duration(2.0).sample_every(0.01) {
///     // The loop of a real machine waits for its next period here.
///     live.show(&sample?)?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Live<'m, M, const NQ: usize, const NV: usize, const NU: usize> {
    mechanism: &'m M,
    /// Indices of the mechanism's frames that the live view draws.
    frames: Vec<usize>,
    /// Number of coordinates that the live view plots.
    plotted: usize,
    server: PageServer,
    /// Newest message of the live view: the time in eight bytes, then for each frame its position and its
    /// quaternion x y z w, then the plotted coordinates, then the inputs, each in four bytes.
    message: Vec<u8>,
    samples: u64,
}

impl<'m, M, const NQ: usize, const NV: usize, const NU: usize> Live<'m, M, NQ, NV, NU>
where
    M: Mechanism<NQ, NV, NU> + Drawn<NQ, NV, Scalar = <M as Mechanism<NQ, NV, NU>>::Scalar>,
{
    /// Opens a live view at a port of this machine, `http://127.0.0.1:PORT/`; at any free port for port 0.
    ///
    /// # Errors
    ///
    /// [`Error::Port`] if another program uses the port or the operating system denies it; the errors of
    /// [`Motion::of`] for the neutral configuration.
    pub fn open(mechanism: &'m M, port: u16) -> Result<Self, Error> {
        Live::of(mechanism, Figure::of(mechanism), port)
    }

    /// Opens a live view as [`open`](Self::open) does, with a drawing that contains more than the declared
    /// pieces, such as meshes or terrain.
    ///
    /// # Errors
    ///
    /// As for [`open`](Self::open) and [`Motion::figure`].
    pub fn of(mechanism: &'m M, figure: Figure, port: u16) -> Result<Self, Error> {
        let name = std::any::type_name::<M>();
        let name = name.split('<').next().and_then(|path| path.rsplit("::").next()).unwrap_or("Mechanism");
        let zero = linkwork::nalgebra::convert(0.0);
        let neutral = Sample {
            t: zero,
            q: mechanism.neutral(),
            v: linkwork::nalgebra::SVector::repeat(zero),
            u: linkwork::nalgebra::SVector::repeat(zero),
            event: None,
            violation: zero,
        };
        let motion = Motion::of("", mechanism, &[neutral])?.figure(figure)?.mark_as_live();
        let frames = motion.used_frames();
        let [plotted, _] = motion.curve_and_input_counts();
        let server = PageServer::open_server(port, Page::new(name).motion(motion).html())?;
        Ok(Live { mechanism, frames, plotted, server, message: Vec::new(), samples: 0 })
    }

    /// Returns the address of the live view, to be opened in a browser.
    pub fn url(&self) -> String {
        format!("http://{}/", self.server.server_address())
    }

    /// Shows a sample in the live view. The call computes and copies the placements of the frames and never
    /// blocks. Samples that a browser does not read in time are dropped: if samples follow each other faster
    /// than the screen refreshes, the newest one is shown.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if a placement, a coordinate or an input is not finite; the sample is then not
    /// shown.
    pub fn show(
        &mut self,
        sample: &Sample<<M as Mechanism<NQ, NV, NU>>::Scalar, NQ, NV, NU>,
    ) -> Result<(), Error> {
        self.message.clear();
        self.message.extend(to_double(sample.t).to_le_bytes());
        let number = self.samples as usize;
        self.samples += 1;
        let not_finite_error = |frame: &str| Error::NotFinite {
            motion: "the live view".to_string(),
            sample: number,
            frame: frame.to_string(),
        };
        for frame in &self.frames {
            let frame_not_finite_error = || not_finite_error(M::FRAMES.get(*frame).unwrap_or(&""));
            let placement = self
                .mechanism
                .placement_of(*frame, sample.t, &sample.q)
                .ok_or_else(frame_not_finite_error)?;
            let placement = placement_in_double(&placement);
            let matrix = placement.rotation.matrix();
            if !placement.translation.vector.iter().chain(matrix.iter()).all(|x| x.is_finite()) {
                return Err(frame_not_finite_error());
            }
            let turn = UnitQuaternion::from_rotation_matrix(&placement.rotation);
            let numbers = placement.translation.vector.iter().chain(turn.coords.iter());
            self.message.extend(numbers.flat_map(|x| (*x as f32).to_le_bytes()));
        }
        let state = sample.q.iter().take(self.plotted).chain(&sample.u).map(|x| to_double(*x));
        for x in state.clone().chain([to_double(sample.t)]) {
            if !x.is_finite() {
                return Err(not_finite_error("state"));
            }
        }
        self.message.extend(state.flat_map(|x| (x as f32).to_le_bytes()));
        self.server.publish_message(&self.message);
        Ok(())
    }
}
