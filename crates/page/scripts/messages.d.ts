// Messages from the scripts to the solver. Written by `tests/house/messages.rs` from the requests in Rust.

// A request, in JSON with its name under `do`. Values are SI, points are in the picture. An outcome has
// `outcome` (`reached`, `stopped`, `refused`), and unless reached `message`, `at` (in the picture) and
// `assembles`. A request that cannot be done is answered by `error`.
export type PageRequest =
  // Opens a file with the contents of others beside it; answers `page`, or `problems`. Undo returns
  // to the file before if that is `kept`.
  | { do: "open"; name: string; text: string; files?: [string, string][]; kept?: boolean }
  // Answers the parts of the moving picture.
  | { do: "picture" }
  // Draws anew, at the same scale if that is to be kept; answers `picture` and `page`.
  | { do: "redraw"; keep?: boolean }
  // Moves a driver; answers an outcome.
  | { do: "drive"; driver: number; value: number }
  // Sets the rates of a driver.
  | { do: "speed"; driver: number; velocity: number; acceleration: number }
  // Sets an input, or that of a force; answers an outcome, and the `value` reached.
  | { do: "load"; input: number; value: number }
  // Goes to a time; answers an outcome.
  | { do: "time"; value: number }
  // Sets a parameter, maybe by assembling anew; answers an outcome.
  | { do: "set"; parameter: number; value: number; anew?: boolean }
  // Answers `grip`: the point of a body at a place.
  | { do: "grab"; body: number; at: [number, number] }
  // Pulls a grip towards a place; answers an outcome.
  | { do: "drag"; body: number; grip: [number, number]; at: [number, number] }
  // Holds a grip by a spring to a place; answers an outcome.
  | { do: "hold"; body: number; grip: [number, number]; at: [number, number] }
  // Lets go what is held.
  | { do: "let_go" }
  // Keeps the present state for undo; answers `done`.
  | { do: "keep" }
  // Returns to the values and the pose of the file; answers `done`.
  | { do: "reset" }
  // Returns to the state before; answers `done`, of another file `page` and `file`.
  | { do: "undo" }
  // Returns to the state that undo left; answers `done`, of another file `page` and `file`.
  | { do: "redo" }
  // Answers `pictures` of all ways to close, and whether they are `complete`.
  | { do: "assemblies" }
  // Takes one of the ways to close; answers an outcome.
  | { do: "choose"; index: number }
  // Answers `x`, `y` and `events` of variables along a driver, without one along time.
  | { do: "chart"; driver?: number | null; variables: number[]; samples: number }
  // Traces a point of a body, without them none; answers `done`.
  | { do: "trace"; body?: number | null; grip?: [number, number] | null }
  // Answers `points` of the traced point's path, in the picture.
  | { do: "path"; driver?: number | null; samples: number }
  // Answers `poses`, lists of the places of the parts.
  | { do: "poses"; driver?: number | null; samples: number }
  // Answers `svg`: the diagram.
  | { do: "diagram" }
  // Answers `text`: the file as the mechanism is now, or with its `parameters` alone.
  | { do: "text"; parameters?: boolean };

// A request, in JSON with its name under `do`. Each that draws may have the `scale` of the picture
// [units per metre]. A view has `text`, `problems`, `is_stale` (the drawing is of an earlier text),
// `status`, `sketch`, `picture`, `can_undo`, `can_redo`; one that is only shown has status and picture.
// A refusal, under `refused`, has `message`, or asks by `parameter`, `formula` and `value`. A request
// that cannot be read is answered by `error`.
export type StudioRequest =
  // Begins with a file, with the contents of others beside it, and maybe with the history that its
  // text had; answers a view.
  | { do: "begin"; name: string; text: string; files?: [string, string][]; history?: History | null; scale?: number | null }
  // Answers the `history` of the text, by which another studio begins where this one is.
  | { do: "history" }
  // Takes a text that was typed, maybe `joined` to the change before; answers a view.
  | { do: "type"; text: string; joined?: boolean; scale?: number | null }
  // Does a gesture with lengths of these decimals, or only shows it; answers a view or a refusal.
  | { do: "gesture"; gesture: Gesture; keep?: boolean; decimals?: number | null; scale?: number | null }
  // Returns to the text before; answers a view.
  | { do: "text_undo"; scale?: number | null }
  // Returns to the text that undo left; answers a view.
  | { do: "text_redo"; scale?: number | null }
  // Answers a view.
  | { do: "view"; scale?: number | null }
  // Answers a form of a thing by its name, of a point by its markers' paths, or of the mechanism:
  // `title`, `kind`, `rows` and `actions`; or a refusal.
  | { do: "inspect"; names: string[] };

// The texts to which undo and redo return: each as its change from the one that is left for it, the next
// one last.
export type History = { before: Change[]; undone: Change[] };

// A change of a text: begin and end of the bytes that are replaced, and what takes their place.
export type Change = [number, number, string];

// A gesture, with its name under `kind`. Points are global [m], angles in radians.
export type Gesture =
  // Adds a bar or a plate through points.
  | { kind: "link"; points: Target[] }
  // Fixes a point to ground.
  | { kind: "pivot"; marker: string }
  // Makes a weld of a pin, as it is drawn.
  | { kind: "weld"; joint: string }
  // Welds a point to ground, as it is drawn.
  | { kind: "weld_to_ground"; marker: string }
  // Moves a point onto another one and pins it there.
  | { kind: "join"; marker: string; onto: string; through?: Through | null }
  // Lets a point slide on a guide of ground.
  | { kind: "slider"; target: Target; angle: number }
  // Lets a point slide along a bar.
  | { kind: "slot"; marker: string; body: string }
  // Drives the distance between two points.
  | { kind: "cylinder"; points: Target[] }
  // Adds two wheels: in mesh, which meet at a `contact`, or on a belt, with `radii`. Those that are
  // `fixed` are part of the bodies of the markers at their centres.
  | { kind: "wheels"; type: WheelPair; points: Target[]; fixed?: [boolean, boolean]; contact?: [number, number] | null; radii?: [number, number] | null }
  // Adds a pinion and its rack.
  | { kind: "rack"; point: Target; contact: [number, number] }
  // Adds a cam and its follower, a knife unless another one is named; or a cam that a roller at a point
  // `of` another body follows.
  | { kind: "cam"; point: Target; contact: [number, number]; of?: string | null; follower?: Follower }
  // Lets a point run in a track of ground through its own place and others.
  | { kind: "curve"; marker: string; points: [number, number][] }
  // Adds a rope over points.
  | { kind: "rope"; points: Target[] }
  // Couples the coordinates of two joints one to one.
  | { kind: "coupling"; joints: [string, string] }
  // Adds a shape to a body, otherwise to one that has all the points. The radius of one that has a
  // radius is the distance of its `rim`.
  | { kind: "shape"; shape: ShapeKind; body?: string | null; points: Target[]; rim?: [number, number] | null }
  // Keeps the shapes at two points from entering each other.
  | { kind: "contact"; points: [Target, Target] }
  // Adds a spring between two points.
  | { kind: "spring"; points: Target[] }
  // Adds a damper between two points.
  | { kind: "damper"; points: Target[] }
  // Adds a force at a point.
  | { kind: "load"; marker: string }
  // Gives a body a mass [kg], the usual one if there is no number.
  | { kind: "mass"; body: string; mass?: number | null }
  // Gives a joint friction.
  | { kind: "friction"; joint: string }
  // Drives a joint.
  | { kind: "driver"; joint: string }
  // Lets a joint move by the forces.
  | { kind: "freedom"; joint: string }
  // Limits a driver, or else a joint; at usual limits if none is given.
  | { kind: "stop"; driver?: string | null; joint?: string | null; min?: number | null; max?: number | null }
  // Moves points.
  | { kind: "shift"; markers: string[]; by: [number, number]; through?: Through | null }
  // Sets the distance between two points, or makes it a parameter with a name.
  | { kind: "length"; markers: string[]; value?: number | null; name?: string | null; through?: Through | null }
  // Makes a number of the file a parameter.
  | { kind: "parameter"; path: string[]; element?: number | null; name: string }
  // Sets a value of the file, or an element of a list there; takes it away without one.
  | { kind: "put"; path: string[]; element?: number | null; value?: unknown }
  // Gives a thing another name.
  | { kind: "rename"; old: string; new: string }
  // Takes things away.
  | { kind: "delete"; names: string[] }
  // Copies bodies by a way.
  | { kind: "duplicate"; bodies: string[]; by: [number, number] }
  // Copies bodies mirrored over the line through a point.
  | { kind: "mirror"; bodies: string[]; at: [number, number]; angle: number }
  // Shows the path of a point, or no longer.
  | { kind: "trace"; marker: string };

// Two wheels that turn together.
export type WheelPair =
  | "gear"
  | "internal"
  | "belt"
  | "crossed";

// The part of a follower that touches the cam.
export type Follower =
  | "knife"
  | "roller"
  | "flat";

// Kind of a shape.
export type ShapeKind =
  | "disc"
  | "bar"
  | "outline"
  | "hole";

// The answer to the question whether a parameter changes or the number in its place.
export type Through =
  | "parameter"
  | "number";

// A click: where it is, and what is there.
export type Click = { at: [number, number]; marker?: string | null; body?: string | null; ground?: boolean };

// The place at which a gesture acts.
export type Target = Click;

// A request, in JSON with its name under `do`. Contents of files are in base64; a request that fails is
// answered by `problems`, one per line.
export type ExportRequest =
  // Answers the `content` of an FMU for hosts of FMI `2` or `3`, with libraries for platforms, and
  // maybe with a page, for which this is the solver.
  | { do: "export"; name: string; text: string; files?: Files; fmi: string; libraries: Files; page?: string | null }
  // Answers the `content` of the drawing of the pose at the start, and `notes`.
  | { do: "dxf"; name: string; text: string; files?: Files }
  // Answers the `content` of an assembly for FreeCAD or OndselSolver, of the pose at the start, and
  // `notes`.
  | { do: "asmt"; name: string; text: string; files?: Files }
  // Answers the `content` of a document of Linkage, of the pose at the start, and `notes`.
  | { do: "linkage2"; name: string; text: string; files?: Files }
  // Answers `svg`: the drawing of the pose at the start.
  | { do: "svg"; name: string; text: string; files?: Files }
  // Answers the `content` of the moving picture.
  | { do: "gif"; name: string; text: string; files?: Files }
  // Reads the `content` of a file, or a link, of another program, whose lengths are in a unit; answers
  // the `text` of the mechanism file, its `name` and `notes`.
  | { do: "import"; name: string; content: string; length?: string | null };

// Names with contents.
export type Files = [string, string][];
