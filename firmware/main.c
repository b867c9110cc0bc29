/* Track a file of Doppler shifts: track < shifts.csv > track.csv
 *
 * A line of shifts.csv is a time in s and the shift of each sensor in Hz; an
 * empty field, or nan, is a sensor that is missing. A first line of names is
 * left out. Array, noise, start and alarm are those of setting.h.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "doppler_tracker.h"
#include "setting.h"

#define LINE 1024 /* characters of a line, at most */

/* Read the numbers of a line; return whether it holds as many, and no more. */
static int read_numbers(char *text, double *numbers, int count)
{
    int i;

    for (i = 0; i < count; i++) {
        const size_t length = strcspn(text, ",\r\n");
        const int last = text[length] != ',';
        char *end = text;
        text[length] = '\0';
        numbers[i] = strtod(text, &end);
        if (end == text)
            numbers[i] = (double)NAN;
        if (end[strspn(end, " \t")] != '\0' || last != (i == count - 1))
            return 0;
        text += length + 1;
    }
    return 1;
}

static int wrong(int line, const char *expectation)
{
    fprintf(stderr, "line %d: %s\n", line, expectation);
    return EXIT_FAILURE;
}

int main(void)
{
    const doppler_setting *setting = &SETTING;
    doppler_track track;
    doppler_real z[SENSORS];
    double numbers[1 + SENSORS], before = 0;
    char text[LINE];
    int i, line, samples = 0;

    doppler_start(&track, START, START_COVARIANCE);
    puts("time,x,y,z,v_x,v_y,v_z,nis,updated,distance,distance_std,alarm");
    for (line = 1; fgets(text, LINE, stdin) != NULL; line++) {
        doppler_decision decision;
        /* Time stays a double: a float knows a day to some milliseconds. */
        double T = INTERVAL;
        if (line == 1 && strspn(text, " \t+-.0123456789") == 0)
            continue;
        if (strchr(text, '\n') == NULL && !feof(stdin))
            return wrong(line, "must be shorter");
        if (!read_numbers(text, numbers, 1 + SENSORS))
            return wrong(line, "must be a time and one field for each sensor");
        if (samples++ > 0)
            T = numbers[0] - before;
        if (!(T > 0 && T < HUGE_VAL))
            return wrong(line, "must have a later time than the line before");
        before = numbers[0];
        for (i = 0; i < SENSORS; i++)
            z[i] = (doppler_real)numbers[1 + i];
        doppler_cycle(&track, setting, (doppler_real)T, z);
        decision = doppler_stop(&track, setting);
        printf("%.17g", numbers[0]);
        for (i = 0; i < 6; i++)
            printf(",%.17g", (double)track.x[i]);
        printf(",%.17g,%d,%.17g,%.17g,%d\n", (double)track.nis, track.updated,
               (double)decision.distance, (double)decision.distance_std,
               decision.alarm);
    }
    return ferror(stdin) || fflush(stdout) == EOF ? EXIT_FAILURE : EXIT_SUCCESS;
}
