/* The compiled form of lowering the nearest cards' depths; plain_covering.py has the same arithmetic in numpy.
 *
 * A card has nine numbers: its middle, its half-extents right and up, its ridge (x and y each, in cells), and its depth.
 * Compiled without contraction, so every processor computes the same bits.
 */
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stdint.h>

typedef struct { float x, y; } Flat;
typedef struct { Flat middle, right, up, ridge; float depth; } Card;
typedef struct { float right, up; } Dot;

/* What is no number lies in the first cell, not out of the grid. */
static inline int32_t within(float position, float last) {
    return (int32_t)(position > 0.0f ? (position > last ? last : position) : 0.0f);
}

static void lower_card(float *nearest, int rows, int columns, const Card *card, const Dot *dots, int64_t count) {
    const float last_row = (float)(rows - 1), last_column = (float)(columns - 1);
    for (int64_t i = 0; i < count; i++) {
        float right = dots[i].right, up = dots[i].up, aside = right - up;
        float before = 1.0f - (aside < 0.0f ? -aside : aside);
        float x = right * card->right.x, y = right * card->right.y;
        x += up * card->up.x, y += up * card->up.y;
        x += before * card->ridge.x, y += before * card->ridge.y;
        x += card->middle.x, y += card->middle.y;
        float *cell = nearest + (int64_t)within(y, last_row) * columns + within(x, last_column);
        if (card->depth < *cell) *cell = card->depth;
    }
}

/* Lower the depths of a grid's cells to those of the cards whose dots lie in them. */
static PyObject *lower(PyObject *Py_UNUSED(self), PyObject *args) {
    PyObject *array;
    Py_buffer nearest, cards, kinds, dots, starts;
    if (!PyArg_ParseTuple(args, "Oy*y*y*y*", &array, &cards, &kinds, &dots, &starts)) return NULL;
    int bad = PyObject_GetBuffer(array, &nearest, PyBUF_WRITABLE | PyBUF_ND) < 0;
    if (bad) { PyErr_Clear(); nearest.obj = NULL, nearest.ndim = 0; }
    int64_t count = kinds.len / (int64_t)sizeof(int64_t), known = starts.len / (int64_t)sizeof(int64_t) - 1;
    const int64_t *kind = kinds.buf, *start = starts.buf;
    bad = bad || nearest.ndim != 2 || nearest.itemsize != sizeof(float) || nearest.shape[0] < 1 || nearest.shape[1] < 1
        || cards.len != (int64_t)sizeof(Card) * count || known < 0
        || start[0] != 0 || start[known] != dots.len / (int64_t)sizeof(Dot);
    for (int64_t i = 0; !bad && i < known; i++) bad = start[i] > start[i + 1];
    for (int64_t i = 0; !bad && i < count; i++) bad = kind[i] < 0 || kind[i] >= known;
    if (bad) {
        PyErr_SetString(PyExc_ValueError, "the arrays do not fit together");
    } else {
        int rows = (int)nearest.shape[0], columns = (int)nearest.shape[1];
        Py_BEGIN_ALLOW_THREADS
        for (int64_t i = 0; i < count; i++) {
            const Dot *first = (const Dot *)dots.buf + start[kind[i]];
            lower_card(nearest.buf, rows, columns, (const Card *)cards.buf + i, first, start[kind[i] + 1] - start[kind[i]]);
        }
        Py_END_ALLOW_THREADS
    }
    if (nearest.obj) PyBuffer_Release(&nearest);
    PyBuffer_Release(&cards);
    PyBuffer_Release(&kinds);
    PyBuffer_Release(&dots);
    PyBuffer_Release(&starts);
    if (bad) return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"lower", lower, METH_VARARGS, "Lower depths (h, w) of a grid by cards (m, 9), kinds (m), dots (k, 2), starts."},
    {NULL, NULL, 0, NULL}};
static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, "_covering", "Lowers the depths of cells behind cards.", -1,
                                    methods, NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__covering(void) { return PyModule_Create(&module); }
