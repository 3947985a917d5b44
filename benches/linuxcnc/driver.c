/* LinuxCNC's trajectory planner over a file of lines, without LinuxCNC: how long it takes, and how hard.
 *
 * In: programs of G0 and G1 with limits of the axes (`contours.rs` writes them), tolerances. Out: a row each.
 *
 * This file is ours, under the licences of this project, and holds nothing of LinuxCNC. `run` compiles it on
 * the computer of its user together with sources of LinuxCNC that the user has (GPL version 2). What comes of
 * that is under the GPL, is never distributed, and is no part of this project.
 *
 * What stands around the planner in LinuxCNC is done here as it does it:
 * - Lines are joined as G64 Q asks: as long as all points left out lie within Q of the straight line, a
 *   hundred at most.
 * - A line is as fast as its feed and the axes permit; its acceleration is what the axes permit.
 * - The queue is kept full, which a slow computer would not always do.
 * - The planner is asked every millisecond. Its positions pass the spline that stands before the joints
 *   (`cubic.c`), and those of the joints are measured: differences of one, two and three of them.
 */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rtapi.h"
#include "posemath.h"
#include "emcpose.h"
#include "motion.h"
#include "motion_types.h"
#include "tp.h"
#include "tc.h"
#include "cubic.h"

enum { AXES = 3, JOINED_MOST = 100, QUEUE = DEFAULT_TC_QUEUE_SIZE, EMPTY_CYCLES = 10 };
static const double CYCLE_S = 0.001;
/* No program takes longer, s. */
static const double LONGEST_S = 3600.0;
/* Way of the path in which the foot of the next position is sought, mm; how far from the end the last may
 * be; by how much a later foot is nearer. */
static const double AHEAD_MM = 1.0, END_MM = 0.1, NOISE_MM = 1e-9;

typedef struct { double at[AXES]; } Point;
typedef struct { Point *all; size_t count, room; } Points;
typedef struct { double v, a, j; } Limits;
typedef struct { Points points; Limits axes[AXES]; double feed; const char *name; } Program;
typedef struct { Limits axes[AXES]; double time, deviation, corner; size_t lines; } Found;

static Limits limits[AXES];
static emcmot_status_t status;
static emcmot_config_t config;

/* ---- what the planner asks of the rest of LinuxCNC ---- */

void rtapi_print(const char *form, ...) { (void)form; }
void rtapi_print_msg(msg_level_t level, const char *form, ...)
{
    if (level != RTAPI_MSG_ERR) return;
    va_list words;
    va_start(words, form);
    vfprintf(stderr, form, words);
    va_end(words);
}
static void no_digital(int pin, char value) { (void)pin; (void)value; }
static void no_analog(int pin, double value) { (void)pin; (void)value; }
static void no_unlock(int joint, int value) { (void)joint; (void)value; }
static int is_unlocked(int joint) { (void)joint; return 1; }
static double velocity_of(int axis) { return axis < AXES ? limits[axis].v : 0.0; }
static double acceleration_of(int axis) { return axis < AXES ? limits[axis].a : 0.0; }

/* ---- points ---- */

static void fail(const char *form, ...)
{
    va_list words;
    va_start(words, form);
    vfprintf(stderr, form, words);
    va_end(words);
    fputc('\n', stderr);
    exit(1);
}

static void add(Points *points, Point point)
{
    if (points->count == points->room) {
        points->room = points->room ? 2 * points->room : 1024;
        points->all = realloc(points->all, points->room * sizeof(Point));
        if (!points->all) fail("no memory for %zu points", points->room);
    }
    points->all[points->count++] = point;
}

static Point less(Point a, Point b)
{
    for (int i = 0; i < AXES; i++) a.at[i] -= b.at[i];
    return a;
}

static double dot(Point a, Point b)
{
    double sum = 0.0;
    for (int i = 0; i < AXES; i++) sum += a.at[i] * b.at[i];
    return sum;
}

static double length(Point a) { return sqrt(dot(a, a)); }

/* Distance of a point from a straight line with two ends; share of the line at which the foot lies. */
static double aside(Point point, Point from, Point to, double *share)
{
    Point way = less(to, from), seen = less(point, from);
    double all = dot(way, way), along = all > 0.0 ? dot(way, seen) / all : 0.0;
    along = fmin(fmax(along, 0.0), 1.0);
    for (int i = 0; i < AXES; i++) seen.at[i] -= along * way.at[i];
    if (share) *share = along;
    return length(seen);
}

/* ---- programs ---- */

/* Whether a G code asks for arcs, inches, steps from place to place, or another kind of feed. */
static int is_other(double g)
{
    return g == 2 || g == 3 || g == 20 || g == 91 || g == 93 || g == 95;
}

/* Reads a line of words G, X, Y, Z, F and others that say what holds here anyway. */
static void read_words(Program *program, const char *text, int line, Point *at)
{
    int moves = 0;
    for (const char *c = text; *c;) {
        if (isspace((unsigned char)*c)) { c++; continue; }
        char letter = *c++, *end;
        double value = strtod(c, &end);
        if (end == c) fail("%s:%d: a number is missing behind %c", program->name, line, letter);
        c = end;
        if (letter >= 'X' && letter <= 'Z') { at->at[letter - 'X'] = value; moves = 1; }
        else if (letter == 'F') program->feed = value / 60.0;
        else if (letter == 'G' && is_other(value))
            fail("%s:%d: G%g: only lines, in mm, absolute, mm/min", program->name, line, value);
        else if (letter == 'G' && value == 0 && program->points.count)
            fail("%s:%d: G0: only the way to the first point may be a rapid", program->name, line);
        else if (!strchr("GMPQN", letter)) fail("%s:%d: %c is unknown here", program->name, line, letter);
    }
    if (!moves) return;
    Points *points = &program->points;
    if (points->count && length(less(*at, points->all[points->count - 1])) == 0.0) return;
    add(points, *at);
}

static void read_program(Program *program, const char *name)
{
    memset(program, 0, sizeof *program);
    program->name = name;
    FILE *file = fopen(name, "r");
    if (!file) fail("%s cannot be read", name);
    char text[512];
    Point at = {{0.0}};
    for (int line = 1; fgets(text, sizeof text, file); line++) {
        char axis;
        Limits of;
        if (sscanf(text, "; limits %c %lf mm/s %lf mm/s2 %lf mm/s3", &axis, &of.v, &of.a, &of.j) == 4) {
            if (axis < 'X' || axis > 'Z' || of.v <= 0 || of.a <= 0 || of.j <= 0)
                fail("%s:%d: limits of X, Y, Z above 0", name, line);
            program->axes[axis - 'X'] = of;
            continue;
        }
        text[strcspn(text, ";(")] = 0;
        read_words(program, text, line, &at);
    }
    fclose(file);
    for (int i = 0; i < AXES; i++)
        if (program->axes[i].v <= 0.0)
            fail("%s: a line `; limits %c 250 mm/s 3000 mm/s2 120000 mm/s3` is missing", name, 'X' + i);
    if (program->feed <= 0.0) fail("%s: F is missing", name);
    if (program->points.count < 2) fail("%s: no line", name);
}

/* Points without those within `q` of the straight line from the last that stayed. */
static Points joined(const Points *points, double q)
{
    Points kept = {0};
    size_t from = 0;
    add(&kept, points->all[0]);
    while (from + 1 < points->count) {
        size_t to = from + 1;
        for (int is_good = 1; is_good && to + 1 < points->count && to - from <= JOINED_MOST;) {
            for (size_t k = from + 1; k <= to && is_good; k++)
                is_good = q > 0.0 && aside(points->all[k], points->all[from], points->all[to + 1], NULL) <= q;
            if (is_good) to++;
        }
        add(&kept, points->all[to]);
        from = to;
    }
    return kept;
}

/* ---- the planner ---- */

static EmcPose pose(Point point)
{
    EmcPose all;
    memset(&all, 0, sizeof all);
    all.tran.x = point.at[0];
    all.tran.y = point.at[1];
    all.tran.z = point.at[2];
    return all;
}

static void prepare(TP_STRUCT *planner, Point start, double tolerance)
{
    double fastest = 0.0, hardest = 0.0;
    for (int i = 0; i < AXES; i++) {
        fastest = fmax(fastest, limits[i].v);
        hardest = fmax(hardest, limits[i].a);
    }
    memset(planner, 0, sizeof *planner);
    memset(&status, 0, sizeof status);
    memset(&config, 0, sizeof config);
    status.net_feed_scale = 1.0;
    /* What LinuxCNC has where its configuration says nothing. */
    config.maxFeedScale = 1.0;
    config.arcBlendEnable = 1;
    config.arcBlendOptDepth = 50;
    config.arcBlendGapCycles = 4;
    config.arcBlendRampFreq = 100.0;
    config.arcBlendTangentKinkRatio = 0.1;
    config.trajCycleTime = config.servoCycleTime = CYCLE_S;
    tpMotFunctions(no_digital, no_analog, no_unlock, is_unlocked, velocity_of, acceleration_of);
    tpMotData(&status, &config);
    if (tpCreate(planner, QUEUE, 0)) fail("the planner cannot be made");
    tpSetCycleTime(planner, CYCLE_S);
    tpSetVmax(planner, 2.0 * fastest, 2.0 * fastest);
    tpSetVlimit(planner, 2.0 * fastest);
    tpSetAmax(planner, 2.0 * hardest);
    EmcPose place = pose(start);
    tpSetPos(planner, &place);
    tpSetTermCond(planner, TC_TERM_COND_PARABOLIC, tolerance);
}

static void hand(TP_STRUCT *planner, const Program *program, Point from, Point to, size_t number)
{
    Point way = less(to, from);
    double v = INFINITY, a = INFINITY;
    for (int i = 0; i < AXES; i++) {
        double share = fabs(way.at[i]) / length(way);
        if (share * length(way) < 1e-7) continue;
        v = fmin(v, limits[i].v / share);
        a = fmin(a, limits[i].a / share);
    }
    struct state_tag_t tag;
    memset(&tag, 0, sizeof tag);
    tpSetId(planner, (int)number);
    double feed = fmin(v, program->feed);
    int said = tpAddLine(planner, pose(to), EMC_MOTION_TYPE_FEED, feed, v, a, FS_ENABLED, 0, -1, tag);
    if (said < 0) fail("%s: the planner refuses line %zu with %d", program->name, number, said);
}

/* Positions of the joints at every cycle, a few at rest before and behind. */
static Points moved(const Program *program, const Points *corners, double tolerance, double *time)
{
    static TP_STRUCT planner;
    CUBIC_STRUCT joints[AXES];
    Points record = {0};
    Point start = corners->all[0];
    prepare(&planner, start, tolerance);
    for (int i = 0; i < AXES; i++) {
        cubicInit(&joints[i]);
        cubicSetInterpolationRate(&joints[i], 1);
        cubicSetSegmentTime(&joints[i], CYCLE_S);
        /* It takes a point for each that was asked of it. */
        cubicAddPoint(&joints[i], start.at[i]);
        cubicInterpolate(&joints[i], NULL, NULL, NULL, NULL);
    }
    for (int k = 0; k < EMPTY_CYCLES; k++) add(&record, start);
    size_t next = 1, cycles = 0, rest = 0;
    while (rest < EMPTY_CYCLES) {
        for (; next < corners->count && !tcqFull(&planner.queue); next++)
            hand(&planner, program, corners->all[next - 1], corners->all[next], next);
        tpRunCycle(&planner, (long)(1e9 * CYCLE_S));
        EmcPose at;
        tpGetPos(&planner, &at);
        double of[AXES] = {at.tran.x, at.tran.y, at.tran.z};
        Point joint;
        for (int i = 0; i < AXES; i++) {
            if (cubicAddPoint(&joints[i], of[i])) fail("%s: the spline refuses a point", program->name);
            joint.at[i] = cubicInterpolate(&joints[i], NULL, NULL, NULL, NULL);
        }
        add(&record, joint);
        if (tpIsDone(&planner) && next == corners->count) rest++; else cycles++;
        if (cycles * CYCLE_S > LONGEST_S) fail("%s: not done after %g s", program->name, LONGEST_S);
    }
    *time = cycles * CYCLE_S;
    double left = length(less(record.all[record.count - 1], corners->all[corners->count - 1]));
    if (left > 1e-6) fail("%s: it ends %g mm off", program->name, left);
    return record;
}

/* ---- what came of it ---- */

static void differ(const Points *record, Limits *most)
{
    const double h = CYCLE_S;
    memset(most, 0, AXES * sizeof *most);
    for (size_t k = 3; k < record->count; k++) {
        for (int i = 0; i < AXES; i++) {
            double x[4];
            for (int n = 0; n < 4; n++) x[n] = record->all[k - n].at[i];
            most[i].v = fmax(most[i].v, fabs(x[0] - x[1]) / h);
            most[i].a = fmax(most[i].a, fabs(x[0] - 2 * x[1] + x[2]) / (h * h));
            most[i].j = fmax(most[i].j, fabs(x[0] - 3 * x[1] + 3 * x[2] - x[3]) / (h * h * h));
        }
    }
}

/* The largest distance of points from a path through others. Feet never go back, and each is sought on a piece
 * of the path as long as twice the way since the last and AHEAD_MM. */
static double away(const Points *points, const Points *path)
{
    size_t line = 1;
    Point foot = path->all[0];
    double most = 0.0;
    for (size_t k = 1; k < points->count; k++) {
        double least = INFINITY, ahead = 0.0;
        double reach = AHEAD_MM + 2.0 * length(less(points->all[k], points->all[k - 1]));
        Point from = foot, there = foot;
        for (size_t n = line; n < path->count && ahead < reach; n++) {
            double share, off = aside(points->all[k], from, path->all[n], &share);
            Point way = less(path->all[n], from);
            if (off < least - NOISE_MM) {
                least = off;
                line = n;
                for (int i = 0; i < AXES; i++) there.at[i] = from.at[i] + share * way.at[i];
            }
            ahead += length(way);
            from = path->all[n];
        }
        foot = there;
        most = fmax(most, least);
    }
    if (line + 1 < path->count && length(less(foot, path->all[path->count - 1])) > END_MM)
        fail("the path was lost in line %zu of %zu", line, path->count - 1);
    return most;
}

static Found measure(const Program *program, double tolerance, double q)
{
    Found found;
    memcpy(limits, program->axes, sizeof limits);
    Points corners = joined(&program->points, q);
    Points record = moved(program, &corners, tolerance, &found.time);
    differ(&record, found.axes);
    found.lines = corners.count - 1;
    found.deviation = away(&record, &program->points);
    found.corner = away(&program->points, &record);
    free(corners.all);
    free(record.all);
    return found;
}

int main(int count, char **words)
{
    if (count < 4) fail("usage: %s P Q FILE...   (tolerances of G64, mm)", words[0]);
    double tolerance = strtod(words[1], NULL), q = strtod(words[2], NULL);
    if (!(tolerance > 0.0) || !(q >= 0.0)) fail("P is above 0 and Q not below, mm");
    printf("seconds lines joined  v/V X Y Z  a/A X Y Z  j/J X Y Z  path_um corner_um  file\n");
    for (int n = 3; n < count; n++) {
        Program program;
        read_program(&program, words[n]);
        Found found = measure(&program, tolerance, q);
        printf("%.3f %zu %zu ", found.time, program.points.count - 1, found.lines);
        for (int i = 0; i < AXES; i++) printf(" %.3f", found.axes[i].v / limits[i].v);
        for (int i = 0; i < AXES; i++) printf(" %.3f", found.axes[i].a / limits[i].a);
        for (int i = 0; i < AXES; i++) printf(" %.2f", found.axes[i].j / limits[i].j);
        printf("  %.2f %.2f  %s\n", 1000.0 * found.deviation, 1000.0 * found.corner, words[n]);
        free(program.points.all);
    }
    return 0;
}
