// Painters of the robot: with WebGL, or without it. Each is given figures ({ turns, tint, share, alpha }) and a screen.
import { apply, AWAY, place, times } from "./body.js";

const LIGHT = [-0.425, 0.709, 0.567]; // direction to the light: right, up, towards the viewer
const DARKEST = 0.42; // brightness of a face that is turned away from the light
const LIFT = [0.010, 0.040]; // by how much (m) the parts on the skull count as nearer when faces are sorted: all, the last more
const BEHIND = `
  attribute vec3 at, normal, colour;
  uniform mat3 turn, axes;
  uniform vec3 frame;
  varying vec3 across, own;
  void main() {
    vec3 seen = (at * turn - vec3(0.0, 0.0, frame.z)) * axes;
    float away = ${AWAY.toFixed(2)} - seen.z;
    across = normal * turn * axes;
    own = colour;
    gl_Position = vec4(seen.xy * frame.xy, 1.5 * away - 1.0, away);
  }`;
const INSIDE = `
  precision mediump float;
  uniform vec4 tint;
  uniform float alpha;
  varying vec3 across, own;
  void main() {
    vec3 n = normalize(across), light = vec3(${LIGHT});
    float lit = mix(${DARKEST}, 1.0, clamp(0.5 + 0.62 * dot(n, light), 0.0, 1.0));
    float shine = 0.2 * pow(max(dot(n, normalize(light + vec3(0.0, 0.0, 1.0))), 0.0), 30.0);
    float rim = 0.16 * pow(1.0 - abs(n.z), 3.0);
    vec3 colour = mix(own, tint.rgb, tint.a) * lit + shine + rim * vec3(0.7, 0.85, 1.0);
    float seen = alpha < 1.0 ? mix(alpha, 0.9, pow(1.0 - abs(n.z), 2.0)) : 1.0; // of a ghost mostly the outline
    gl_FragColor = vec4(min(colour, 1.0) * seen, seen);
  }`;

// Returns faces ({ corners: numbers of points, colour, order }) and unit normals of the points of a body.
function prepare({ path, points, solids }, tenths) {
  const at = [], faces = [];
  for (let index = 0; index < points.length; index += 3) at.push(points.slice(index, index + 3).map((length) => length / tenths));
  const normals = at.map(() => [0, 0, 0]);
  solids.forEach(([colour, corners], solid) => {
    for (let index = 0; index < corners.length; index += 4) {
      const face = corners.slice(index, index + 4);
      const [a, b, c, d] = face.map((corner) => at[corner]);
      const [p, q] = [[c, a], [d, b]].map(([to, from]) => to.map((length, axis) => length - from[axis]));
      const normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
      for (const corner of face) normals[corner] = normals[corner].map((length, axis) => length + normal[axis]);
      faces.push({ corners: face, colour, normal: unit(normal), lift: path === "head" && solid ? LIFT[0] + LIFT[1] * (solid / solids.length) ** 2 : 0 });
    }
  });
  return { path, at, faces, normals: normals.map(unit) };
}

// Returns four faces for each, on a round surface through the points (Phong tessellation).
function refined({ path, at, faces, normals }) {
  const body = { path, at: [...at], normals: [...normals] }, made = new Map();
  const sum = (vectors) => [0, 1, 2].map((axis) => vectors.reduce((total, vector) => total + vector[axis], 0));
  const middle = (...corners) => {
    const key = corners.sort((one, other) => one - other).join();
    if (!made.has(key)) {
      const flat = sum(corners.map((corner) => at[corner])).map((length) => length / corners.length);
      const lifts = sum(corners.map((corner) => {
        const height = at[corner].reduce((total, length, axis) => total + (length - flat[axis]) * normals[corner][axis], 0);
        return normals[corner].map((length) => length * height / corners.length);
      }));
      made.set(key, body.at.push(flat.map((length, axis) => length + 0.75 * lifts[axis])) - 1);
      body.normals.push(unit(sum(corners.map((corner) => normals[corner]))));
    }
    return made.get(key);
  };
  body.faces = faces.flatMap(({ corners: [a, b, c, d], ...face }) => {
    const [m, ab, bc, cd, da] = [middle(a, b, c, d), middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
    return [[a, ab, m, da], [ab, b, bc, m], [m, bc, c, cd], [da, m, cd, d]].map((corners) => ({ ...face, corners }));
  });
  return body;
}

const unit = (vector) => vector.map((length) => length / Math.max(Math.hypot(...vector), 1e-12));

// Returns a painter for browsers with WebGL.
export function webgl(canvas, model) {
  const gl = canvas.getContext("webgl", { antialias: true });
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, BEHIND], [gl.FRAGMENT_SHADER, INSIDE]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  ["at", "normal", "colour"].forEach((name, index) => { // the places are chosen, because to ask for them takes long
    gl.bindAttribLocation(program, index, name);
    gl.enableVertexAttribArray(index);
  });
  gl.linkProgram(program);
  gl.useProgram(program);
  const [turn, axes, frame, tint, alpha] = ["turn", "axes", "frame", "tint", "alpha"].map((name) => gl.getUniformLocation(program, name));
  const bodies = model.bodies.map((body) => upload(gl, prepare(body, model.tenths)));
  for (const mode of [gl.DEPTH_TEST, gl.CULL_FACE, gl.BLEND]) gl.enable(mode);
  gl.depthFunc(gl.LEQUAL);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

  const drawBodies = ({ turns, alpha }) => {
    for (const { path, points, corners, few, all } of bodies.filter((body) => turns[body.path])) {
      gl.uniformMatrix3fv(turn, false, turns[path]);
      gl.bindBuffer(gl.ARRAY_BUFFER, points);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, corners);
      for (const index of [0, 1, 2]) gl.vertexAttribPointer(index, 3, gl.FLOAT, false, 36, 12 * index);
      gl.drawElements(gl.TRIANGLES, alpha < 1 ? few : all, gl.UNSIGNED_SHORT, alpha < 1 ? 0 : 2 * few); // a ghost is coarse
    }
  };
  return (figures, screen) => {
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniformMatrix3fv(axes, false, screen.axes);
    gl.uniform3f(frame, 2 * screen.scale * AWAY / screen.width, 2 * screen.scale * AWAY / screen.height, screen.lookedAt);
    for (const figure of figures) {
      gl.uniform4f(tint, ...figure.tint.map((part) => part / 255), figure.share);
      gl.uniform1f(alpha, figure.alpha);
      gl.clear(gl.DEPTH_BUFFER_BIT); // a ghost is seen through what is before it
      if (figure.alpha < 1) { // only its surface, not what is inside
        gl.colorMask(false, false, false, false);
        drawBodies(figure);
        gl.colorMask(true, true, true, true);
      }
      drawBodies(figure);
    }
  };
}

function upload(gl, coarse) {
  const fine = coarse.path === "head" ? refined(coarse) : coarse; // the other bodies have sharp edges
  const values = new Float32Array(9 * fine.at.length);
  fine.at.forEach((point, index) => values.set([...point, ...fine.normals[index]], 9 * index));
  for (const { corners, colour } of fine.faces) {
    for (const corner of corners) values.set(colour.map((part) => part / 255), 9 * corner + 6);
  }
  const triangles = ({ faces }) => faces.flatMap(({ corners: [a, b, c, d] }) => (c === d ? [a, b, c] : [a, b, c, a, c, d]));
  const few = triangles(coarse), all = triangles(fine);
  const [points, corners] = [gl.createBuffer(), gl.createBuffer()];
  gl.bindBuffer(gl.ARRAY_BUFFER, points);
  gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, corners);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array([...few, ...all]), gl.STATIC_DRAW);
  return { path: coarse.path, points, corners, few: few.length, all: all.length };
}

// Returns a painter that sorts shaded faces, for browsers without WebGL.
export function flat(canvas, model) {
  const paper = canvas.getContext("2d"), bodies = model.bodies.map((body) => prepare(body, model.tenths));
  return (figures, screen) => {
    const ratio = canvas.width / screen.width;
    paper.setTransform(ratio, 0, 0, ratio, 0, 0);
    paper.clearRect(0, 0, screen.width, screen.height);
    paper.lineJoin = "round";
    for (const { turns, tint, share, alpha } of figures) {
      const found = [];
      for (const { path, at, faces } of bodies.filter((body) => turns[body.path])) {
        const points = at.map((point) => place(screen, apply(turns[path], point)));
        const seen = times(screen.axes, turns[path]);
        const light = [0, 1, 2].map((axis) => LIGHT[0] * seen[axis] + LIGHT[1] * seen[axis + 3] + LIGHT[2] * seen[axis + 6]);
        for (const { corners, colour, normal, lift } of faces) {
          const [a, b, c, d] = corners.map((corner) => points[corner]);
          if ((c[0] - a[0]) * (d[1] - b[1]) > (c[1] - a[1]) * (d[0] - b[0])) continue; // turned away
          const bright = 0.5 + 0.62 * (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]);
          const lit = DARKEST + (1 - DARKEST) * Math.min(1, Math.max(0, bright));
          const shade = colour.map((part, index) => Math.round((part * (1 - share) + tint[index] * share) * lit));
          found.push({ corners: [a, b, c, d], shade: `rgb(${shade})`, near: (a[2] + b[2] + c[2] + d[2]) / 4 + lift });
        }
      }
      paper.globalAlpha = alpha;
      for (const { corners, shade } of found.sort((one, other) => one.near - other.near)) {
        paper.fillStyle = paper.strokeStyle = shade;
        paper.beginPath();
        for (const [x, y] of corners) paper.lineTo(x, y);
        paper.closePath();
        paper.fill();
        if (alpha === 1) paper.stroke(); // no ground shows between neighbours
      }
    }
    paper.globalAlpha = 1;
  };
}
