"""A scene as MuJoCo reads it: MJCF, for its adapters in C++ and JavaScript."""


def text(numbers):
    return " ".join(repr(float(x)) for x in numbers)


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def size(shape):
    return {"plane": "0 0 1", "sphere": str(shape.get("radius")), "box": text(shape.get("half", ()))}[shape["kind"]]


def body(scene, k, origin):
    """A body, and inside it those that hang on it by a joint: these have no other freedom."""
    b = scene["bodies"][k]
    held = next((j for j in scene["joints"] if j["a"] == k), None)
    if b["motion"] == "driven":  # too heavy to be stopped
        freedom = f'<joint type="slide" axis="{text(b["velocity"])}" armature="1e12"/>'
    elif held:
        freedom = f'<joint type="ball" pos="{text(minus(held["at"], b["at"]))}"/>'
    else:
        freedom = "<freejoint/>" if b["motion"] == "free" else ""
    geoms = "".join(f'<geom type="{s["kind"]}" size="{size(s)}" pos="{text(s["at"])}"/>' for s in b["shapes"])
    inside = "".join(body(scene, j["a"], b["at"]) for j in scene["joints"] if j["b"] == k)
    return (f'<body name="b{k}" pos="{text(minus(b["at"], origin))}" quat="{text(b["turn"])}">{freedom}'
            f'<inertial pos="0 0 0" mass="{b["mass"]}" diaginertia="{text(b["inertia"])}"/>{geoms}{inside}</body>')


def mjcf(scene, setting):
    """`scene` has numbers for fractions. The tuned setting: a round cone, contacts as stiff as the step allows, and friction without slip."""
    tuned = setting == "tuned"
    option = 'cone="elliptic" impratio="100" noslip_iterations="100" iterations="1000" tolerance="0"' if tuned else ""
    contact = f'solref="{2 * scene["dt"]!r} 1" solimp="0.99 0.9999 0.001"' if tuned else ""
    roots = "".join(body(scene, k, (0, 0, 0)) for k in range(len(scene["bodies"])) if not any(j["a"] == k and j["b"] >= 0 for j in scene["joints"]))
    sensors = "".join(f'<frame{what} objtype="xbody" objname="b{k}"/>' for k in range(len(scene["bodies"])) for what in ("pos", "quat", "linvel", "angvel"))
    return (f'<mujoco><option timestep="{scene["dt"]!r}" gravity="{text(scene["gravity"])}" {option}/>'
            f'<default><geom friction="{scene["mu"]!r} 0 0" {contact}/></default><worldbody>{roots}</worldbody><sensor>{sensors}</sensor></mujoco>')
