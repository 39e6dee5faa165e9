/* A V4L2 camera for tests: preloaded into a program, it answers the ioctls that the program makes on a named pipe.
 *
 * The system itself opens the pipe and waits for it. The structures are those of the system's header, so a program that
 * fills them wrongly fails. Pictures come through the pipe, each after two numbers: its length in bytes, and 1 if the
 * camera marks it as damaged. A picture of no bytes unplugs the camera. Pictures that come before the stream starts are
 * discarded. A file beside the pipe, named like it with `.refuses` at the end, contains an errno and a rate (1/s): a
 * stream at this rate or above does not start, but fails with the errno. During a stream a file that ends in `.asked`
 * contains the settings of the stream. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { BUFFERS = 8, LENGTH = 1 << 20, CAMERAS = 16, WAIT_MS = 50 };

struct camera {
    struct v4l2_pix_format format;
    struct v4l2_fract period;
    unsigned count, sequence;
    char queued[BUFFERS];
    unsigned char *memory[BUFFERS];
};
static struct camera cameras[CAMERAS]; /* by file descriptor modulo CAMERAS; a test opens one or two */

static int is_camera(int fd) {
    struct stat status;
    return fd >= 0 && fstat(fd, &status) == 0 && S_ISFIFO(status.st_mode);
}

static void beside(int fd, const char *suffix, char *path) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, path, PATH_MAX - 16);
    strcpy(path + (length < 0 ? 0 : length), suffix);
}

static int fails(int number) {
    errno = number;
    return -1;
}

static int receive(int fd, void *to, size_t length) {
    for (char *at = to; length > 0;) {
        struct pollfd ready = {fd, POLLIN, 0};
        ssize_t got = poll(&ready, 1, WAIT_MS) == 1 ? read(fd, at, length) : -1;
        if (got <= 0) return fails(EAGAIN);
        at += got;
        length -= (size_t)got;
    }
    return 0;
}

static int stream_on(int fd, struct camera *camera) {
    char path[PATH_MAX], old[4096];
    beside(fd, ".asked", path);
    FILE *file = fopen(path, "w");
    if (file) {
        fprintf(file, "%ux%u %.4s %u/%u %u", camera->format.width, camera->format.height,
                (char *)&camera->format.pixelformat, camera->period.numerator, camera->period.denominator,
                camera->count);
        fclose(file);
    }
    beside(fd, ".refuses", path);
    int number = 0;
    unsigned rate = 0;
    file = fopen(path, "r");
    if (file) {
        int read = fscanf(file, "%d %u", &number, &rate);
        fclose(file);
        if (read == 2 && camera->period.denominator >= rate * camera->period.numerator) return fails(number);
    }
    while (read(fd, old, sizeof old) > 0) {}
    return 0;
}

static int stream_off(int fd) {
    char path[PATH_MAX];
    beside(fd, ".asked", path);
    unlink(path);
    return 0;
}

static int dequeue(int fd, struct camera *camera, struct v4l2_buffer *buffer) {
    uint32_t head[2];
    unsigned index = 0;
    while (index < camera->count && !camera->queued[index]) index++;
    if (index == camera->count || receive(fd, head, sizeof head)) return fails(EAGAIN);
    if (head[0] == 0) return fails(ENODEV);
    if (head[0] > LENGTH || receive(fd, camera->memory[index], head[0])) return fails(EIO);
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    camera->queued[index] = 0;
    buffer->index = index;
    buffer->bytesused = head[0];
    buffer->length = LENGTH;
    buffer->sequence = camera->sequence++;
    buffer->flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    if (head[1]) buffer->flags |= V4L2_BUF_FLAG_ERROR;
    buffer->timestamp.tv_sec = now.tv_sec;
    buffer->timestamp.tv_usec = now.tv_nsec / 1000;
    return 0;
}

static int answer(int fd, struct camera *camera, unsigned request, void *about) {
    struct v4l2_buffer *buffer = about;
    switch (request) {
    case VIDIOC_QUERYCAP: {
        struct v4l2_capability *known = about;
        memset(known, 0, sizeof *known);
        strcpy((char *)known->driver, "fake");
        strcpy((char *)known->card, "Camera of a test");
        known->device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        known->capabilities = known->device_caps | V4L2_CAP_DEVICE_CAPS;
        return 0;
    }
    case VIDIOC_S_FMT: {
        struct v4l2_format *format = about;
        if (format->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fails(EINVAL);
        format->fmt.pix.sizeimage = LENGTH;
        camera->format = format->fmt.pix;
        return 0;
    }
    case VIDIOC_G_FMT:
        ((struct v4l2_format *)about)->fmt.pix = camera->format;
        return 0;
    case VIDIOC_S_PARM:
        camera->period = ((struct v4l2_streamparm *)about)->parm.capture.timeperframe;
        return 0;
    case VIDIOC_REQBUFS: {
        struct v4l2_requestbuffers *wanted = about;
        if (wanted->memory != V4L2_MEMORY_MMAP) return fails(EINVAL);
        camera->count = wanted->count < BUFFERS ? wanted->count : BUFFERS;
        memset(camera->queued, 0, sizeof camera->queued);
        wanted->count = camera->count;
        return 0;
    }
    case VIDIOC_QUERYBUF:
        if (buffer->index >= camera->count) return fails(EINVAL);
        buffer->length = LENGTH;
        buffer->m.offset = buffer->index * LENGTH;
        return 0;
    case VIDIOC_QBUF:
        if (buffer->index >= camera->count || !camera->memory[buffer->index]) return fails(EINVAL);
        camera->queued[buffer->index] = 1;
        return 0;
    case VIDIOC_DQBUF:
        return dequeue(fd, camera, buffer);
    case VIDIOC_STREAMON:
        return stream_on(fd, camera);
    case VIDIOC_STREAMOFF:
        return stream_off(fd);
    default:
        return fails(EINVAL); /* no controls, inputs, standards */
    }
}

int ioctl(int fd, unsigned long request, ...) {
    va_list list;
    va_start(list, request);
    void *about = va_arg(list, void *);
    va_end(list);
    if (!is_camera(fd) || _IOC_TYPE((unsigned)request) != 'V') {
        int (*real)(int, unsigned long, ...) = (int (*)(int, unsigned long, ...))dlsym(RTLD_NEXT, "ioctl");
        return real(fd, request, about);
    }
    return answer(fd, &cameras[fd % CAMERAS], (unsigned)request, about);
}

void *mmap64(void *at, size_t length, int protection, int flags, int fd, off64_t offset) {
    void *(*real)(void *, size_t, int, int, int, off64_t) =
        (void *(*)(void *, size_t, int, int, int, off64_t))dlsym(RTLD_NEXT, "mmap64");
    if (!is_camera(fd)) return real(at, length, protection, flags, fd, offset);
    void *memory = real(at, length, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory != MAP_FAILED && offset / LENGTH < BUFFERS) cameras[fd % CAMERAS].memory[offset / LENGTH] = memory;
    return memory;
}

void *mmap(void *at, size_t length, int protection, int flags, int fd, off_t offset) {
    return mmap64(at, length, protection, flags, fd, offset);
}
