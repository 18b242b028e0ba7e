% Times GNU Octave on one case, and prints JSON: octave peer.m CASES NAME
%
% The kind of program that the method was first published with: a rigid-body chain in an interpreted language, and
% general solvers with finite differences: fsolve for the 42 hinge angles, fzero for the force, and fsolve, in the
% least-squares sense, for multipliers and forces.
1;

function spine = read_case(path, name)
  cases = jsondecode(fileread(path)).cases;
  given = cases(strcmp({cases.name}, name));
  spine.multipliers = given.multipliers;
  spine.region = 1 + [given.joints.region]';
  spine.nominal = [given.joints.stiffness_nmm_per_rad];
  spine.base = given.vertebrae(1).midpoint_mm;
  spine.axes = given.vertebrae(1).axes;
  for j = 1:14
    below = given.vertebrae(j);
    above = given.vertebrae(j + 1);
    spine.centre(:, j) = below.axes' * (given.joints(j).centre_mm - below.midpoint_mm);
    spine.rise(:, j) = below.axes' * (above.midpoint_mm - given.joints(j).centre_mm);
    spine.rest{j} = below.axes' * above.axes;
  end
  for b = 1:2
    bend = given.bends(b);
    spine.unit{b} = [cross(bend.point_mm, bend.direction); bend.direction];
    spine.force(b) = bend.force_n;
    spine.lean(b) = bend.lean_rad;
    location = bend.locations_mm / given.noise.location_mm;
    spine.data{b} = [location(2:end, 1); location(2:end, 2); bend.tilts_rad(2:end) / given.noise.tilt_rad];
  end
  spine.sd = [given.noise.location_mm, given.noise.tilt_rad];
  spine.starts = given.starts;
end

function k = stiffness(spine, multipliers)
  k = spine.nominal;
  k(1, :) .*= multipliers(spine.region)';
  k = k(:);
end

% Midpoints and cranial axes, and what a wrench (moment about the origin, force) does at every hinge.
function [load, midpoints, cranial] = chain(spine, q, wrench)
  load = zeros(42, 1);
  midpoints = cranial = zeros(3, 15);
  r = spine.axes;
  p = spine.base;
  midpoints(:, 1) = p;
  cranial(:, 1) = r(:, 3);
  s = sin(q);
  c = cos(q);
  for j = 1:14
    i = 3 * j - 2;
    centre = p + r * spine.centre(:, j);
    f = wrench(4:6);
    moment = wrench(1:3) - [centre(2) * f(3) - centre(3) * f(2)
                            centre(3) * f(1) - centre(1) * f(3)
                            centre(1) * f(2) - centre(2) * f(1)];
    rx = r * [1, 0, 0; 0, c(i), -s(i); 0, s(i), c(i)];
    ry = rx * [c(i + 1), 0, s(i + 1); 0, 1, 0; -s(i + 1), 0, c(i + 1)];
    load(i:i + 2) = moment' * [r(:, 1), rx(:, 2), ry(:, 3)];
    r = ry * [c(i + 2), -s(i + 2), 0; s(i + 2), c(i + 2), 0; 0, 0, 1];
    p = centre + r * spine.rise(:, j);
    r = r * spine.rest{j};
    midpoints(:, j + 1) = p;
    cranial(:, j + 1) = r(:, 3);
  end
end

function q = equilibrium(spine, k, wrench, q)
  options = optimset("TolX", 1e-10, "TolFun", 1e-10);
  [q, ~, info] = fsolve(@(q) q - chain(spine, q, wrench) ./ k, q, options);
  if info <= 0
    error("fsolve ended with %d", info);
  end
end

% Miss of the amplitude under a force, from the shape under the last one.
function miss = lean_miss(spine, k, b, force)
  persistent q;
  if force == 0
    q = zeros(42, 1);
  end
  wrench = force * spine.unit{b};
  q = equilibrium(spine, k, wrench, q);
  [~, midpoints] = chain(spine, q, wrench);
  miss = atan2(-midpoints(2, 15), midpoints(3, 15)) - spine.lean(b);
end

% More force by steps of 10 N until the amplitude is passed, then fzero.
function force = match(spine, k, b)
  before = lean_miss(spine, k, b, 0);
  force = 0;
  do
    force += 10;
    now = lean_miss(spine, k, b, force);
  until now * before <= 0
  force = fzero(@(f) lean_miss(spine, k, b, f), [force - 10, force], optimset("TolX", 1e-10));
end

% x: two log-multipliers, of which the third is minus the sum, and two forces. Shapes go on from the last ones.
function residual = misfit(spine, x)
  persistent shapes;
  if isempty(x)
    shapes = zeros(42, 2);
    return;
  end
  k = stiffness(spine, exp([x(1); x(2); -x(1) - x(2)]));
  residual = [];
  for b = 1:2
    wrench = x(2 + b) * spine.unit{b};
    shapes(:, b) = equilibrium(spine, k, wrench, shapes(:, b));
    [~, p, c] = chain(spine, shapes(:, b), wrench);
    tilt = atan2(-c(2, 2:end), c(3, 2:end))' / spine.sd(2);
    seen = [[p(2, 2:end)'; p(3, 2:end)'] / spine.sd(1); tilt];
    residual = [residual; seen - spine.data{b}];
  end
end

function x = personalise(spine, start)
  logs = start.log_multipliers - mean(start.log_multipliers);
  misfit(spine, []);
  options = optimset("TolX", 1e-9, "TolFun", 1e-9, "MaxIter", 100);
  x = fsolve(@(x) misfit(spine, x), [logs(1:2); start.forces_n], options);
end

function seconds = timed(work, repeats)
  times = zeros(repeats, 1);
  for i = 1:repeats
    start = cputime();
    work();
    times(i) = cputime() - start;
  end
  seconds = median(times);
end

function row = equilibria(spine, k, near)
  row.task = "equilibrium";
  if near
    row.task = "equilibrium_near";
  end
  row.method = "fsolve, finite differences";
  row.midpoints_mm = zeros(2, 15, 3);
  for b = 1:2
    wrench = spine.force(b) * spine.unit{b};
    start = zeros(42, 1);
    if near
      start = equilibrium(spine, k, 0.95 * wrench, start);
    end
    [~, midpoints] = chain(spine, equilibrium(spine, k, wrench, start), wrench);
    row.midpoints_mm(b, :, :) = midpoints';
    seconds(b) = timed(@() equilibrium(spine, k, wrench, start), 3);
  end
  row.seconds = mean(seconds);
end

function row = amplitude(spine, k)
  row.task = "amplitude";
  row.method = "fzero around fsolve";
  start = cputime();
  row.forces_n = [match(spine, k, 1), match(spine, k, 2)];
  row.seconds = (cputime() - start) / 2;
end

function row = personalisation(spine, name)
  row.task = "personalisation";
  row.method = ["fsolve around fsolve; " strrep(name, "_", "-") " start"];
  start = cputime();
  try
    x = personalise(spine, spine.starts.(name));
    row.seconds = cputime() - start;
    row.multipliers = exp([x(1), x(2), -x(1) - x(2)]);
    row.forces_n = x(3:4)';
  catch reason
    row.failed = reason.message;
  end
end

arguments = argv();
spine = read_case(arguments{1}, arguments{2});
k = stiffness(spine, spine.multipliers);
said.engine = "octave";
said.version = OCTAVE_VERSION;
said.case = arguments{2};
said.cannot = {"nothing is given: kinematics are the user's own, and fsolve and fzero differentiate by differences"};
said.rows = {equilibria(spine, k, false), equilibria(spine, k, true), amplitude(spine, k)};
said.rows = [said.rows, {personalisation(spine, "nominal"), personalisation(spine, "closed_form")}];
disp(jsonencode(said));
