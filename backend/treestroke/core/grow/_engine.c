/* The compiled evaluator of growth; reference.py has the same mathematics in plain numpy.
 *
 * Why it is fast: only attractors within reach of a branch are measured; the nearest of the evenly spaced samples of
 * a segment has a closed form; a gain of an earlier iteration remains an upper bound (the sum of distances is
 * submodular and pruning only removes shoots), so few placements are evaluated again (lazy evaluation, Minoux 1978);
 * the closeness test is done last, for placements with the greatest bound. Compiled without contraction or fast-math,
 * so every processor computes the same bits.
 *
 * "flat" is the image (2D), "solid" is space (3D); lengths are px of the crown's frame.
 */
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDE
#endif

#define MAX_SHOOTS 16
#define BUCKETS 65536
#define ROUND 6755399441055744.0 /* 1.5 * 2^52: adding and subtracting it rounds to the nearest integer, ties to even */
#define TIE 1e-9
#define COARSE 1.0 /* least ratio of attractors' distance to groups' width at which groups bound gains well */

typedef struct { double x, y, z; } Vec;
typedef struct { Vec base, step; int samples, kept; } Segment;
typedef struct { double *x, *y, *z, *d; int n, room; } Points;
typedef struct { uint16_t *kept; double *bound[2]; int *fresh[2], *exact[2]; int seen[2], placed; Vec centre; double radius; } Visit;
typedef struct { int parent; double fraction, root, reach; Vec lever; } Shoot;
typedef struct { double kept, added; } Steer;
typedef struct { int branch, placement; double gain; } Found;
typedef struct { double *x, *y, *low, *high, *slope, *sum, *size; int n; } Groups;
typedef struct { Visit *visit; Points near; int branch, gathered, top; double bound; } Slot;

typedef struct {
    PyObject_HEAD
    int height, width, subtrees, angles, shoots, turn;
    uint8_t *mask;
    double *middle, *radius, *near, *deep, *scale, spacing, closeness, keep, cosine;
    Vec foot, *turned, *base, *tip;
    Steer *steer;
    int *count;
    Shoot *library;
    Points points[2]; /* 0 in the image, 1 in space */
    double *away; /* distance of each image attractor from its group's middle */
    int *first; /* index of each group's first attractor, then the number of attractors */
    Groups groups, near_groups;
    Segment *segments;
    Visit **visits;
    int branches, room;
    Vec *grid;
    int *next, bucket[BUCKETS], filled, grid_room;
    Slot *slots;
    int slot_count;
    double *best, *gain;
    int scratch_room;
    Found *found;
    int found_count, found_room;
} Engine;

static int failed(void) { PyErr_NoMemory(); return -1; }

/* ---- vectors: the same order of operations as in reference.py ---- */

static Vec add(Vec a, Vec b) { Vec v = {a.x + b.x, a.y + b.y, a.z + b.z}; return v; }
static Vec sub(Vec a, Vec b) { Vec v = {a.x - b.x, a.y - b.y, a.z - b.z}; return v; }
static Vec times(Vec a, double k) { Vec v = {a.x * k, a.y * k, a.z * k}; return v; }
static double dot(Vec a, Vec b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
static double norm(Vec a) { return sqrt(dot(a, a)); }
static Vec cross(Vec a, Vec b) {
    Vec v = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return v;
}

static Segment segment(const Engine *e, Vec base, Vec along) {
    double samples = (norm(along) / e->spacing + ROUND) - ROUND;
    samples = samples < 1 ? 1 : samples > 60000 ? 60000 : samples;
    Vec step = {along.x / samples, along.y / samples, along.z / samples};
    Segment s = {base, step, (int)samples, (int)samples};
    return s;
}

static int inside(const Engine *e, Vec p) {
    if (!(p.x >= 0 && p.y >= 0 && p.x < e->width && p.y < e->height)) return 0;
    int r = (int)p.y; /* rounds down, as it is not negative */
    if (!e->mask[(size_t)r * e->width + (int)p.x]) return 0;
    double x = (p.x - e->middle[r]) / e->radius[r], z = (p.z - e->near[r]) / e->deep[r];
    return x * x + z * z <= 1;
}

/* Number of the shoot's leading samples inside the crown; 0 where it grows inward or too little of it is kept. */
static int kept_samples(const Engine *e, const Segment *s, Vec along) {
    Vec out = sub(add(s->base, times(along, 0.5)), e->foot);
    if (dot(along, out) < e->cosine * (norm(along) * norm(out))) return 0;
    int k = 1;
    while (k <= s->samples && inside(e, add(s->base, times(s->step, k)))) k++;
    return k - 1 >= e->keep * s->samples ? k - 1 : 0;
}

/* ---- placements ---- */

static int steers(Steer s) { return s.kept != 1 || s.added != 0; }

/* Steer a shoot: keep a share of its rise, add to it, and give the shoot its length back. */
static Vec steered(Vec along, Steer s) {
    double length = norm(along);
    Vec v = {along.x, along.y * s.kept - length * s.added, along.z};
    double turned = norm(v);
    return turned > 0 ? times(v, length / turned) : along;
}

static void frame(const Engine *e, int branch, Vec *u, Vec *a, Vec *v, double *length) {
    Vec d = sub(e->tip[branch], e->base[branch]);
    *length = norm(d);
    a->x = d.x / *length; a->y = d.y / *length; a->z = d.z / *length;
    Vec other = {fabs(a->z) > 0.9, 0, fabs(a->z) <= 0.9};
    Vec side = cross(*a, other);
    double n = norm(side);
    u->x = side.x / n; u->y = side.y / n; u->z = side.z / n;
    *v = cross(*a, *u);
}

/* Compute a placement's shoots on its branch; fill `kept` where it is not known yet. */
static void compute_shoots(const Engine *e, int branch, int placement, uint16_t *kept, int known, Segment *out) {
    int subtree = placement / e->angles;
    Vec u, a, v, along[MAX_SHOOTS];
    double length;
    frame(e, branch, &u, &a, &v, &length);
    double size = length * e->scale[(size_t)branch * e->subtrees + subtree];
    for (int i = 0; i < e->count[subtree]; i++) {
        const Shoot *shoot = &e->library[subtree * e->shoots + i];
        Vec t = e->turned[placement * e->shoots + i];
        int p = shoot->parent;
        along[i].x = ((t.x * u.x + t.y * a.x) + t.z * v.x) * size;
        along[i].y = ((t.x * u.y + t.y * a.y) + t.z * v.y) * size;
        along[i].z = ((t.x * u.z + t.y * a.z) + t.z * v.z) * size;
        if (steers(e->steer[branch])) along[i] = steered(along[i], e->steer[branch]);
        Vec parent = p < 0 ? sub(e->tip[branch], e->base[branch]) : along[p];
        out[i] = segment(e, add(p < 0 ? e->base[branch] : out[p].base, times(parent, shoot->fraction)), along[i]);
        if (!known) {
            int torn = p >= 0 && (kept[p] == 0 || shoot->fraction * out[p].samples > kept[p]);
            kept[i] = size > 0 && !torn ? (uint16_t)kept_samples(e, &out[i], along[i]) : 0;
        }
        out[i].kept = kept[i];
    }
}

static void free_visit(Visit *v) {
    if (!v) return;
    free(v->kept);
    for (int m = 0; m < 2; m++) { free(v->bound[m]); free(v->fresh[m]); free(v->exact[m]); }
    free(v);
}

static Visit *new_visit(const Engine *e) {
    int n = e->subtrees * e->angles;
    Visit *v = calloc(1, sizeof(Visit));
    if (!v) return NULL;
    v->kept = calloc((size_t)n * e->shoots, sizeof(uint16_t));
    int good = v->kept != NULL;
    for (int m = 0; m < 2; m++) {
        v->bound[m] = calloc(n, sizeof(double));
        v->fresh[m] = calloc(n, sizeof(int));
        v->exact[m] = calloc(n, sizeof(int));
        good = good && v->bound[m] && v->fresh[m] && v->exact[m];
    }
    if (!good) { free_visit(v); return NULL; }
    return v;
}

/* The sphere about a branch's middle that contains every placement on it; steered shoots may point anywhere. */
static void bounding_sphere(const Engine *e, int branch, Vec *centre, double *radius) {
    Vec d = sub(e->tip[branch], e->base[branch]);
    double length = norm(d), far = 0.5;
    for (int s = 0; s < e->subtrees; s++)
        for (int i = 0; i < e->count[s]; i++) {
            const Shoot *shoot = &e->library[s * e->shoots + i];
            double size = e->scale[(size_t)branch * e->subtrees + s];
            Vec end = times(shoot->lever, size);
            end.y += shoot->root - 0.5;
            far = fmax(far, steers(e->steer[branch]) ? fabs(shoot->root - 0.5) + size * shoot->reach : norm(end));
        }
    *centre = add(e->base[branch], times(d, 0.5));
    *radius = far * length * (1 + 1e-9) + 1e-9;
}

/* ---- distances ---- */

WIDE static void nearest_flat(const double *x, const double *y, double *best, int n, Segment s) {
    double bx = s.base.x, by = s.base.y, sx = s.step.x, sy = s.step.y, last = s.kept;
    double inverse = 1 / fmax(sx * sx + sy * sy, 1e-300);
    for (int i = 0; i < n; i++) {
        double px = x[i] - bx, py = y[i] - by;
        double t = ((px * sx + py * sy) * inverse + ROUND) - ROUND;
        t = t < 1 ? 1 : t;
        t = t > last ? last : t;
        px -= t * sx; py -= t * sy;
        double q = px * px + py * py;
        best[i] = q < best[i] ? q : best[i];
    }
}

WIDE static void nearest_solid(const double *x, const double *y, const double *z, double *best, int n, Segment s) {
    double bx = s.base.x, by = s.base.y, bz = s.base.z, sx = s.step.x, sy = s.step.y, sz = s.step.z, last = s.kept;
    double inverse = 1 / fmax((sx * sx + sy * sy) + sz * sz, 1e-300);
    for (int i = 0; i < n; i++) {
        double px = x[i] - bx, py = y[i] - by, pz = z[i] - bz;
        double t = (((px * sx + py * sy) + pz * sz) * inverse + ROUND) - ROUND;
        t = t < 1 ? 1 : t;
        t = t > last ? last : t;
        px -= t * sx; py -= t * sy; pz -= t * sz;
        double q = (px * px + py * py) + pz * pz;
        best[i] = q < best[i] ? q : best[i];
    }
}

/* Select the attractors that come nearer, as most do not and square roots are slow; return their number. */
static int nearer(const double *d, double *best, double *before, int n) {
    int count = 0;
    for (int i = 0; i < n; i++) {
        double q = best[i], old = d[i];
        best[count] = q;
        before[count] = old;
        count += q < old * old;
    }
    return count;
}

WIDE static void improvements(const double *best, double *gain, int n) {
    for (int i = 0; i < n; i++) gain[i] -= sqrt(best[i]);
}

static double total(const double *gain, int n) {
    double s[4] = {0, 0, 0, 0};
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < 4; k++) s[k] += gain[i + k];
    for (; i < n; i++) s[0] += gain[i];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

static void nearest(const Points *p, int solid, double *best, Segment s) {
    if (solid) nearest_solid(p->x, p->y, p->z, best, p->n, s);
    else nearest_flat(p->x, p->y, best, p->n, s);
}

static void clear(double *best, int n) { for (int i = 0; i < n; i++) best[i] = 1e300; }

static int room_for(Points *p, int n) {
    if (n <= p->room) return 0;
    int room = n * 2 + 64;
    double **columns[4] = {&p->x, &p->y, &p->z, &p->d};
    for (int i = 0; i < 4; i++) {
        double *grown = realloc(*columns[i], sizeof(double) * room);
        if (!grown) return failed();
        *columns[i] = grown;
    }
    p->room = room;
    return 0;
}

static int scratch_for(Engine *e, int n) {
    if (n <= e->scratch_room) return 0;
    double *best = realloc(e->best, sizeof(double) * n * 2);
    if (best) e->best = best;
    double *gain = realloc(e->gain, sizeof(double) * n * 2);
    if (gain) e->gain = gain;
    if (!best || !gain) return failed();
    e->scratch_room = n * 2;
    return 0;
}

/* Collect the attractors that a placement on the slot's branch may come nearer to; sum upper bounds of their gains. */
static int gather(Engine *e, Slot *slot, int solid) {
    const Points *all = &e->points[solid];
    Points *near = &slot->near;
    Vec c;
    double r, bound = 0;
    if (room_for(near, all->n)) return -1;
    bounding_sphere(e, slot->branch, &c, &r);
    int n = 0;
    for (int i = 0; i < all->n; i++) {
        double x = all->x[i] - c.x, y = all->y[i] - c.y, z = solid ? all->z[i] - c.z : 0, reach = all->d[i] + r;
        double q = (x * x + y * y) + z * z;
        if (q >= reach * reach) continue;
        near->x[n] = all->x[i]; near->y[n] = all->y[i]; near->z[n] = all->z[i]; near->d[n++] = all->d[i];
        bound += all->d[i] - fmax(0, sqrt(q) - r);
    }
    near->n = n;
    slot->gathered = 1;
    slot->bound = bound * (1 + 1e-9);
    return 0;
}

static double gain_of(Engine *e, const Points *near, int solid, const Segment *shoots, int count) {
    int any = 0;
    for (int i = 0; i < count; i++) {
        if (!shoots[i].kept) continue;
        if (!any) clear(e->best, near->n);
        any = 1;
        nearest(near, solid, e->best, shoots[i]);
    }
    if (!any) return 0;
    int n = nearer(near->d, e->best, e->gain, near->n);
    improvements(e->best, e->gain, n);
    return total(e->gain, n);
}

/* ---- a coarse bound: groups of neighbouring image attractors instead of each ----
 *
 * With D the distance of a group's middle to a placement, an attractor at distance d from the tree and `away` from the
 * middle gains at most max(0, d + away - D). Summed over a group this is sum - size * D up to low = min(d + away), 0
 * from high = max(d + away) on, and convex between, hence below the chord.
 */

static void middle_of(Engine *e, int k) {
    const Points *p = &e->points[0];
    double x = 0, y = 0, size = e->first[k + 1] - e->first[k];
    for (int i = e->first[k]; i < e->first[k + 1]; i++) { x += p->x[i] / size; y += p->y[i] / size; }
    for (int i = e->first[k]; i < e->first[k + 1]; i++)
        e->away[i] = sqrt((p->x[i] - x) * (p->x[i] - x) + (p->y[i] - y) * (p->y[i] - y)) * (1 + TIE);
    e->groups.x[k] = x; e->groups.y[k] = y; e->groups.size[k] = size;
}

static void update_groups(Engine *e) {
    Groups *g = &e->groups;
    const double *d = e->points[0].d;
    for (int k = 0; k < g->n; k++) {
        double low = 1e300, high = 0, sum = 0;
        for (int i = e->first[k]; i < e->first[k + 1]; i++) {
            double far = d[i] + e->away[i];
            low = fmin(low, far);
            high = fmax(high, far);
            sum += far;
        }
        g->low[k] = low; g->high[k] = high; g->sum[k] = sum;
        g->slope[k] = high > low ? fmax(0, sum - g->size[k] * low) / (high - low) : 0;
    }
}

/* Collect the groups within reach of a branch; none where they are too coarse to bound gains well. */
static int gather_groups(Engine *e, int branch) {
    const Groups *all = &e->groups;
    Groups *near = &e->near_groups;
    Vec c;
    double r, total = 0, loose = 0;
    bounding_sphere(e, branch, &c, &r);
    near->n = 0;
    for (int k = 0; k < all->n; k++) {
        double x = all->x[k] - c.x, y = all->y[k] - c.y, reach = all->high[k] + r;
        if (x * x + y * y >= reach * reach) continue;
        int n = near->n++;
        near->x[n] = all->x[k]; near->y[n] = all->y[k]; near->low[n] = all->low[k]; near->high[n] = all->high[k];
        near->slope[n] = all->slope[k]; near->sum[n] = all->sum[k]; near->size[n] = all->size[k];
        total += all->sum[k];
        loose += all->size[k] * e->away[e->first[k]];
    }
    if (total < COARSE * loose) near->n = 0;
    return near->n;
}

WIDE static void most_gains(const Groups *g, const double *best, double *gain) {
    for (int k = 0; k < g->n; k++) {
        double d = sqrt(best[k]), within = g->sum[k] - g->size[k] * d, beyond = (g->high[k] - d) * g->slope[k];
        beyond = beyond > 0 ? beyond : 0;
        gain[k] = d <= g->low[k] ? within : beyond;
    }
}

static double most_gain(Engine *e, const Segment *shoots, int count) {
    const Groups *g = &e->near_groups;
    int any = 0;
    clear(e->best, g->n);
    for (int i = 0; i < count; i++) {
        if (!shoots[i].kept) continue;
        any = 1;
        nearest_flat(g->x, g->y, e->best, g->n, shoots[i]);
    }
    if (!any) return 0;
    most_gains(g, e->best, e->gain);
    return total(e->gain, g->n) * (1 + TIE) + TIE;
}

/* ---- closeness ---- */

static int floor_int(double x) { int i = (int)x; return i - (x < i); }

static unsigned cell(int x, int y, int z) {
    return ((unsigned)x * 73856093u ^ (unsigned)y * 19349663u ^ (unsigned)z * 83492791u) % BUCKETS;
}

static int add_sample(Engine *e, Vec p) {
    if (e->filled == e->grid_room) {
        int room = e->grid_room * 2 + 1024;
        Vec *grid = realloc(e->grid, sizeof(Vec) * room);
        if (grid) e->grid = grid;
        int *next = realloc(e->next, sizeof(int) * room);
        if (next) e->next = next;
        if (!grid || !next) return failed();
        e->grid_room = room;
    }
    unsigned at = cell(floor_int(p.x / e->closeness), floor_int(p.y / e->closeness), floor_int(p.z / e->closeness));
    e->grid[e->filled] = p;
    e->next[e->filled] = e->bucket[at];
    e->bucket[at] = e->filled++;
    return 0;
}

static int crowded(const Engine *e, Vec p) {
    int x = floor_int(p.x / e->closeness), y = floor_int(p.y / e->closeness), z = floor_int(p.z / e->closeness);
    double limit = e->closeness * e->closeness;
    for (int i = 0; i < 27; i++)
        for (int k = e->bucket[cell(x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1)]; k >= 0; k = e->next[k]) {
            Vec d = sub(p, e->grid[k]);
            if (dot(d, d) < limit) return 1;
        }
    return 0;
}

/* Drop the shoots whose outer half is too close to the tree, and their children; final, as the tree only grows. */
static void drop_crowded(const Engine *e, int subtree, Segment *shoots, uint16_t *kept) {
    for (int i = 0; i < e->count[subtree]; i++) {
        const Shoot *shoot = &e->library[subtree * e->shoots + i];
        if (shoot->parent >= 0 && kept[shoot->parent] == 0) kept[i] = 0;
        for (int k = (kept[i] + 1) / 2; k <= kept[i] && kept[i]; k++)
            if (crowded(e, add(shoots[i].base, times(shoots[i].step, k)))) kept[i] = 0;
        shoots[i].kept = kept[i];
    }
}

/* ---- the best placement ---- */

static double evaluate(Engine *e, Slot *slot, int solid, int placement, int exact) {
    Segment shoots[MAX_SHOOTS];
    uint16_t *kept = slot->visit->kept + (size_t)placement * e->shoots;
    int subtree = placement / e->angles;
    compute_shoots(e, slot->branch, placement, kept, slot->visit->placed, shoots);
    if (exact) drop_crowded(e, subtree, shoots, kept);
    double gain = gain_of(e, &slot->near, solid, shoots, e->count[subtree]);
    slot->visit->bound[solid][placement] = gain;
    slot->visit->fresh[solid][placement] = e->turn;
    if (exact) slot->visit->exact[solid][placement] = e->turn;
    return gain;
}

static void rescan(const Engine *e, Slot *slot, int solid) {
    const Visit *v = slot->visit;
    slot->top = -1;
    slot->bound = 0;
    for (int i = 0; i < e->subtrees * e->angles; i++)
        if (v->exact[solid][i] != e->turn && v->bound[solid][i] > slot->bound) {
            slot->bound = v->bound[solid][i];
            slot->top = i;
        }
}

static int first_visit(Engine *e, Slot *slot, int solid) {
    if (!slot->visit) slot->visit = e->visits[slot->branch] = new_visit(e);
    if (!slot->visit) return failed();
    bounding_sphere(e, slot->branch, &slot->visit->centre, &slot->visit->radius);
    int coarse = !solid && gather_groups(e, slot->branch);
    for (int i = 0; i < e->subtrees * e->angles; i++) {
        Segment shoots[MAX_SHOOTS];
        if (!coarse) { evaluate(e, slot, solid, i, 0); continue; }
        compute_shoots(e, slot->branch, i, slot->visit->kept + (size_t)i * e->shoots, slot->visit->placed, shoots);
        slot->visit->bound[solid][i] = most_gain(e, shoots, e->count[i / e->angles]);
    }
    slot->visit->seen[solid] = slot->visit->placed = 1;
    return 0;
}

static int record(Engine *e, int branch, int placement, double gain) {
    if (e->found_count == e->found_room) {
        Found *found = realloc(e->found, sizeof(Found) * (e->found_room * 2 + 64));
        if (!found) return failed();
        e->found = found;
        e->found_room = e->found_room * 2 + 64;
    }
    Found f = {branch, placement, gain};
    e->found[e->found_count++] = f;
    return 0;
}

static int open_slots(Engine *e, const int64_t *candidates, int n, int solid) {
    if (n > e->slot_count) {
        Slot *slots = realloc(e->slots, sizeof(Slot) * n);
        if (!slots) return failed();
        memset(slots + e->slot_count, 0, sizeof(Slot) * (n - e->slot_count));
        e->slots = slots;
        e->slot_count = n;
    }
    if (!solid) update_groups(e);
    for (int i = 0; i < n; i++) {
        Slot *slot = &e->slots[i];
        slot->branch = (int)candidates[i];
        slot->visit = e->visits[slot->branch];
        slot->gathered = 0;
        if (slot->visit && slot->visit->seen[solid]) rescan(e, slot, solid);
        else if (gather(e, slot, solid)) return -1;
    }
    return 0;
}

/* Evaluate the placement with the greatest bound one step further: its gain, then also its closeness. */
static int advance(Engine *e, Slot *slot, int solid, double *best) {
    Visit *v = slot->visit;
    if (!v || !v->seen[solid]) {
        if (first_visit(e, slot, solid)) return -1;
    } else {
        double bound = slot->bound;
        int top = slot->top;
        if (!slot->gathered && gather(e, slot, solid)) return -1;
        int exact = v->fresh[solid][top] == e->turn;
        double gain = evaluate(e, slot, solid, top, exact);
        v->bound[solid][top] = fmin(gain, bound);
        if (exact && record(e, slot->branch, top, gain)) return -1;
        if (exact && gain > *best) *best = gain;
    }
    rescan(e, slot, solid);
    return 0;
}

static int search(Engine *e, int n, int solid, Found *winner) {
    double best = 0;
    e->turn++;
    e->found_count = 0;
    for (;;) {
        int top = 0;
        for (int i = 1; i < n; i++) if (e->slots[i].bound > e->slots[top].bound) top = i;
        if (!(e->slots[top].bound > best * (1 - 2 * TIE))) break;
        if (advance(e, &e->slots[top], solid, &best)) return -1;
    }
    winner->branch = -1; winner->placement = 0; winner->gain = 0;
    for (int i = 0; i < e->found_count; i++) {
        Found f = e->found[i];
        if (!(f.gain > 0 && f.gain >= best * (1 - TIE))) continue;
        int earlier = f.branch < winner->branch || (f.branch == winner->branch && f.placement < winner->placement);
        if (winner->branch < 0 || earlier) *winner = f;
    }
    return 0;
}

/* ---- the Python type ---- */

/* Borrow a C-contiguous buffer of the given item size and exactly n items (any number where n < 0). */
static int borrow(PyObject *object, Py_buffer *view, Py_ssize_t item, Py_ssize_t n) {
    if (PyObject_GetBuffer(object, view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT)) return -1;
    if (view->itemsize == item && (n < 0 || view->len == item * n)) return 0;
    PyBuffer_Release(view);
    PyErr_SetString(PyExc_ValueError, "an array has the wrong type or size");
    return -1;
}

static void *copied(PyObject *object, Py_ssize_t item, Py_ssize_t n, Py_ssize_t *length) {
    Py_buffer view;
    if (borrow(object, &view, item, n)) return NULL;
    void *copy = malloc(view.len + 1);
    if (copy) memcpy(copy, view.buf, view.len);
    else PyErr_NoMemory();
    if (length) *length = view.len / item;
    PyBuffer_Release(&view);
    return copy;
}

static int add_point(Engine *e, int solid, Vec p) {
    Points *all = &e->points[solid];
    double best = 1e300;
    Points one = {&p.x, &p.y, &p.z, NULL, 1, 1};
    if (room_for(all, all->n + 1)) return -1;
    for (int b = 0; b < e->branches; b++) nearest(&one, solid, &best, e->segments[b]);
    all->x[all->n] = p.x; all->y[all->n] = p.y; all->z[all->n] = p.z; all->d[all->n++] = sqrt(best);
    return 0;
}

/* A new attractor may raise old gains: raise their bounds by the greatest gain that it allows. */
static void raise_bounds(Engine *e, const Points *p, int i) {
    for (int b = 0; b < e->branches; b++) {
        Visit *v = e->visits[b];
        if (!v || !v->seen[1]) continue;
        Vec at = {p->x[i], p->y[i], p->z[i]};
        double most = (p->d[i] - fmax(0, norm(sub(at, v->centre)) - v->radius)) * (1 + 1e-9);
        for (int k = 0; k < e->subtrees * e->angles && most > 0; k++) v->bound[1][k] += most;
    }
}

static void build_levers(Engine *e) {
    for (int s = 0; s < e->subtrees; s++)
        for (int i = 0; i < e->count[s]; i++) {
            Shoot *all = &e->library[s * e->shoots], *shoot = &all[i];
            const Vec *turned = &e->turned[(size_t)s * e->angles * e->shoots];
            shoot->root = shoot->fraction;
            shoot->lever = turned[i];
            shoot->reach = norm(turned[i]);
            if (shoot->parent < 0) continue;
            const Shoot *p = &all[shoot->parent];
            shoot->root = p->root;
            shoot->lever = add(turned[i], sub(p->lever, times(turned[shoot->parent], 1 - shoot->fraction)));
            shoot->reach += p->reach - (1 - shoot->fraction) * norm(turned[shoot->parent]);
        }
}

static int read_library(Engine *e, PyObject *counts, PyObject *parents, PyObject *fractions, PyObject *vectors) {
    Py_ssize_t n = 0, total_shoots = 0, all = 0;
    int64_t *count = copied(counts, 8, -1, &n), *parent = NULL;
    double *fraction = NULL;
    e->subtrees = (int)n;
    if (count) parent = copied(parents, 8, -1, &total_shoots);
    if (parent) fraction = copied(fractions, 8, total_shoots, NULL);
    if (fraction) e->turned = copied(vectors, 8, -1, &all);
    int good = e->turned && n > 0 && total_shoots > 0 && total_shoots / n <= MAX_SHOOTS && all > 0;
    if (good) {
        e->shoots = (int)(total_shoots / n);
        e->angles = (int)(all / (total_shoots * 3));
        e->count = calloc(n, sizeof(int));
        e->library = calloc(total_shoots, sizeof(Shoot));
        good = e->count && e->library;
    }
    for (int i = 0; good && i < total_shoots; i++) {
        e->count[i / e->shoots] = (int)count[i / e->shoots];
        e->library[i].parent = (int)parent[i];
        e->library[i].fraction = fraction[i];
        good = count[i / e->shoots] <= e->shoots && parent[i] < i % e->shoots;
    }
    free(count); free(parent); free(fraction);
    if (good) build_levers(e);
    else if (!PyErr_Occurred()) PyErr_SetString(PyExc_ValueError, "the library is malformed");
    return good ? 0 : -1;
}

static int engine_init(PyObject *self, PyObject *args, PyObject *Py_UNUSED(keywords)) {
    Engine *e = (Engine *)self;
    PyObject *mask, *middle, *radius, *near, *deep, *counts, *parents, *fractions, *vectors;
    if (e->mask) { PyErr_SetString(PyExc_ValueError, "an engine is initialised once"); return -1; }
    if (!PyArg_ParseTuple(args, "(ii)OOOOO(ddd)ddddOOOO", &e->height, &e->width, &mask, &middle, &radius, &near, &deep,
                          &e->foot.x, &e->foot.y, &e->foot.z, &e->spacing, &e->closeness, &e->keep, &e->cosine,
                          &counts, &parents, &fractions, &vectors)) return -1;
    for (int i = 0; i < BUCKETS; i++) e->bucket[i] = -1;
    if (!(e->mask = copied(mask, 1, (Py_ssize_t)e->height * e->width, NULL))) return -1;
    if (!(e->middle = copied(middle, 8, e->height, NULL))) return -1;
    if (!(e->radius = copied(radius, 8, e->height, NULL))) return -1;
    if (!(e->near = copied(near, 8, e->height, NULL))) return -1;
    if (!(e->deep = copied(deep, 8, e->height, NULL))) return -1;
    return read_library(e, counts, parents, fractions, vectors);
}

static void engine_free(PyObject *self) {
    Engine *e = (Engine *)self;
    for (int b = 0; b < e->branches; b++) free_visit(e->visits[b]);
    for (int i = 0; i < e->slot_count + 2; i++) {
        Points *p = i < 2 ? &e->points[i] : &e->slots[i - 2].near;
        free(p->x); free(p->y); free(p->z); free(p->d);
    }
    for (int i = 0; i < 2; i++) {
        Groups *g = i ? &e->near_groups : &e->groups;
        free(g->x); free(g->y); free(g->low); free(g->high); free(g->slope); free(g->sum); free(g->size);
    }
    void *owned[] = {e->first, e->away, e->mask, e->middle, e->radius, e->near, e->deep, e->scale, e->steer, e->turned,
                     e->base, e->tip, e->count, e->library, e->segments, e->visits, e->grid, e->next, e->slots, e->best,
                     e->gain, e->found};
    for (size_t i = 0; i < sizeof(owned) / sizeof(*owned); i++) free(owned[i]);
    PyTypeObject *type = Py_TYPE(self);
    type->tp_free(self);
    Py_DECREF(type);
}

static int room_for_branches(Engine *e, int n) {
    if (n <= e->room) return 0;
    int room = n * 2 + 64;
    struct { void **at; size_t size; } columns[] = {
        {(void **)&e->base, sizeof(Vec)}, {(void **)&e->tip, sizeof(Vec)}, {(void **)&e->segments, sizeof(Segment)},
        {(void **)&e->visits, sizeof(Visit *)}, {(void **)&e->scale, sizeof(double) * e->subtrees},
        {(void **)&e->steer, sizeof(Steer)}};
    for (int i = 0; i < 6; i++) {
        void *grown = realloc(*columns[i].at, columns[i].size * room);
        if (!grown) return failed();
        *columns[i].at = grown;
    }
    e->room = room;
    return 0;
}

static int add_branch(Engine *e, const double *base, const double *tip, const double *scale, Steer steer) {
    int b = e->branches;
    if (room_for_branches(e, b + 1)) return -1;
    e->base[b] = (Vec){base[0], base[1], base[2]};
    e->tip[b] = (Vec){tip[0], tip[1], tip[2]};
    e->segments[b] = segment(e, e->base[b], sub(e->tip[b], e->base[b]));
    e->visits[b] = NULL;
    e->steer[b] = steer;
    memcpy(e->scale + (size_t)b * e->subtrees, scale, sizeof(double) * e->subtrees);
    e->branches++;
    for (int k = 1; k <= e->segments[b].samples; k++)
        if (add_sample(e, add(e->base[b], times(e->segments[b].step, k)))) return -1;
    return 0;
}

/* Update the attractors' distances with the branches from `first` on. */
static int update_distances(Engine *e, int first) {
    for (int solid = 0; solid < 2; solid++) {
        Points *p = &e->points[solid];
        if (scratch_for(e, p->n + 4)) return -1;
        clear(e->best, p->n);
        for (int b = first; b < e->branches; b++) nearest(p, solid, e->best, e->segments[b]);
        for (int i = 0; i < p->n; i++) p->d[i] = fmin(p->d[i], sqrt(e->best[i]));
    }
    return 0;
}

static PyObject *add_branches(PyObject *self, PyObject *args) {
    Engine *e = (Engine *)self;
    PyObject *bases, *tips, *scales, *steering;
    Py_ssize_t n = 0;
    if (!PyArg_ParseTuple(args, "OOOO", &bases, &tips, &scales, &steering)) return NULL;
    double *base = copied(bases, 8, -1, &n), *tip = NULL, *scale = NULL, *steer = NULL;
    int good = base && (tip = copied(tips, 8, n, NULL)) && (scale = copied(scales, 8, n / 3 * e->subtrees, NULL))
        && (steer = copied(steering, 8, n / 3 * 2, NULL));
    int first = e->branches;
    for (int i = 0; good && i < n / 3; i++)
        good = !add_branch(e, base + 3 * i, tip + 3 * i, scale + (size_t)i * e->subtrees,
                           (Steer){steer[2 * i], steer[2 * i + 1]});
    good = good && !update_distances(e, first);
    free(base); free(tip); free(scale); free(steer);
    if (!good) return NULL;
    Py_RETURN_NONE;
}

static PyObject *add_attractors(PyObject *self, PyObject *args) {
    Engine *e = (Engine *)self;
    PyObject *points;
    int solid;
    Py_ssize_t n = 0;
    if (!PyArg_ParseTuple(args, "Op", &points, &solid)) return NULL;
    double *at = copied(points, 8, -1, &n);
    int good = at != NULL;
    for (int i = 0; good && i < n / 3; i++) {
        Vec p = {at[3 * i], at[3 * i + 1], at[3 * i + 2]};
        good = !add_point(e, solid, p);
        if (good && solid) raise_bounds(e, &e->points[1], e->points[1].n - 1);
    }
    free(at);
    if (!good || scratch_for(e, e->points[solid].n + 4)) return NULL;
    Py_RETURN_NONE;
}

/* Set the groups of neighbouring image attractors: each group's first index, then the number of attractors. */
static PyObject *group(PyObject *self, PyObject *args) {
    Engine *e = (Engine *)self;
    const Points *p = &e->points[0];
    PyObject *starts;
    Py_ssize_t n = 0;
    if (!PyArg_ParseTuple(args, "O", &starts)) return NULL;
    int64_t *start = copied(starts, 8, -1, &n);
    int bad = !start || n < 2 || start[0] != 0 || start[n - 1] != p->n || e->first != NULL;
    for (int k = 0; !bad && k + 1 < n; k++) bad = start[k] >= start[k + 1];
    if (bad) { free(start); return PyErr_Format(PyExc_ValueError, "the groups do not cover the image attractors"); }
    e->first = malloc(sizeof(int) * n);
    e->away = malloc(sizeof(double) * p->n);
    double **columns[] = {&e->groups.x, &e->groups.y, &e->groups.low, &e->groups.high, &e->groups.slope,
                          &e->groups.sum, &e->groups.size, &e->near_groups.x, &e->near_groups.y, &e->near_groups.low,
                          &e->near_groups.high, &e->near_groups.slope, &e->near_groups.sum, &e->near_groups.size};
    int good = e->first && e->away;
    for (int i = 0; i < 14; i++) good = (*columns[i] = calloc(n, sizeof(double))) && good;
    for (int k = 0; good && k < n; k++) e->first[k] = (int)start[k];
    free(start);
    if (!good) return PyErr_NoMemory();
    e->groups.n = (int)n - 1;
    for (int k = 0; k < e->groups.n; k++) middle_of(e, k);
    Py_RETURN_NONE;
}

static PyObject *best(PyObject *self, PyObject *args) {
    Engine *e = (Engine *)self;
    PyObject *candidates;
    int solid, bad = 0, status = 0;
    Py_ssize_t n = 0;
    Found f = {-1, 0, 0};
    if (!PyArg_ParseTuple(args, "Op", &candidates, &solid)) return NULL;
    int64_t *chosen = copied(candidates, 8, -1, &n);
    if (!chosen) return NULL;
    for (int i = 0; i < n; i++) bad |= chosen[i] < 0 || chosen[i] >= e->branches;
    if (!bad && n) status = open_slots(e, chosen, (int)n, solid) || search(e, (int)n, solid, &f);
    free(chosen);
    if (bad) PyErr_SetString(PyExc_ValueError, "a candidate is not the index of a branch");
    if (bad || status) return NULL;
    return Py_BuildValue("(iiid)", f.branch, f.placement / e->angles, f.placement % e->angles, f.gain);
}

/* List the shoots of a placement that pruning leaves; its branch is no candidate any more. */
static PyObject *place(PyObject *self, PyObject *args) {
    Engine *e = (Engine *)self;
    Segment shoots[MAX_SHOOTS];
    uint16_t kept[MAX_SHOOTS];
    int branch, subtree, angle, order[MAX_SHOOTS], n = 0;
    if (!PyArg_ParseTuple(args, "iii", &branch, &subtree, &angle)) return NULL;
    if (branch < 0 || branch >= e->branches || subtree < 0 || subtree >= e->subtrees || angle < 0 || angle >= e->angles)
        return PyErr_Format(PyExc_ValueError, "branch, subtree or angle is out of range");
    compute_shoots(e, branch, subtree * e->angles + angle, kept, 0, shoots);
    drop_crowded(e, subtree, shoots, kept);
    free_visit(e->visits[branch]);
    e->visits[branch] = NULL;
    PyObject *list = PyList_New(0);
    for (int i = 0; list && i < e->count[subtree]; i++) {
        if (!kept[i]) continue;
        const Shoot *shoot = &e->library[subtree * e->shoots + i];
        int p = shoot->parent;
        double fraction = p < 0 ? shoot->fraction : shoot->fraction * shoots[p].samples / kept[p];
        Vec b = shoots[i].base, t = add(b, times(shoots[i].step, kept[i]));
        order[i] = n++;
        PyObject *row = Py_BuildValue("(iddddddd)", p < 0 ? -1 : order[p], fraction, b.x, b.y, b.z, t.x, t.y, t.z);
        if (!row || PyList_Append(list, row)) Py_CLEAR(list);
        Py_XDECREF(row);
    }
    return list;
}

static PyObject *distances(PyObject *self, PyObject *Py_UNUSED(args)) {
    const Points *p = &((Engine *)self)->points[0];
    return PyBytes_FromStringAndSize((const char *)p->d, (Py_ssize_t)sizeof(double) * p->n);
}

static PyMethodDef methods[] = {
    {"add_branches", add_branches, METH_VARARGS, "Add branches: bases and tips (k, 3), px; factors (k, subtrees); steering (k, 2)."},
    {"add_attractors", add_attractors, METH_VARARGS, "Add attractors (m, 3), px, in space or in the image."},
    {"group", group, METH_VARARGS, "Set the groups of image attractors: first indices, then their number."},
    {"best", best, METH_VARARGS, "Find (branch, subtree, angle, gain) of the best placement; branch -1 without gain."},
    {"place", place, METH_VARARGS, "List (parent, fraction, base, tip) of a placement's remaining shoots."},
    {"distances", distances, METH_NOARGS, "Return the image attractors' distances, px, as bytes of float64."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {{Py_tp_init, engine_init}, {Py_tp_dealloc, engine_free}, {Py_tp_methods, methods},
                              {Py_tp_new, PyType_GenericNew}, {0, NULL}};
static PyType_Spec spec = {"treestroke.core.grow._engine.Engine", sizeof(Engine), 0, Py_TPFLAGS_DEFAULT, slots};
static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, "_engine", "The compiled evaluator of growth.", -1, NULL,
                                    NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__engine(void) {
    PyObject *m = PyModule_Create(&module), *type = m ? PyType_FromSpec(&spec) : NULL;
    if (type && !PyModule_AddObjectRef(m, "Engine", type)) { Py_DECREF(type); return m; }
    Py_XDECREF(type);
    Py_XDECREF(m);
    return NULL;
}
